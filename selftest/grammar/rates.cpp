#include "selftest/grammar/rates.h"

#include "gap/stats/tails.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace puckloop::gap::selftest::grammar {

namespace {

template <class Belongs, class Hit>
Rate counted(const std::vector<Outcome>& cases, const Belongs& belongs, const Hit& hit) {
    int hits = 0, of = 0;
    for (const Outcome& one : cases)
        if (belongs(one)) {
            ++of;
            hits += hit(one) ? 1 : 0;
        }
    return rate_of(hits, of);
}

bool unexplained(const Outcome& one) {
    return one.said == "unexplained" || one.said == "cannot_tell" || one.said == "not_identifiable";
}

}  // namespace

bool Target::met() const {
    return rate.of == 0 || (rate.share() >= least && rate.share() <= most && rate.high <= highest);
}

std::vector<Target> targets(const std::vector<Outcome>& cases) {
    const auto is = [](Class of, double least) {
        return [of, least](const Outcome& one) { return one.of == of && one.ratio >= least; };
    };
    const auto said = [](const char* word) {
        return [word](const Outcome& one) { return one.said == word; };
    };
    const auto right = [](const Outcome& one) { return one.right; };
    const auto band = [](double low, double high) {
        return [low, high](const Outcome& one) {
            return one.of == Class::Known && one.ratio >= low && one.ratio < high;
        };
    };
    std::vector<Target> list;
    list.push_back({"unknown, strength 1 and above: called unexplained or cannot tell",
                    counted(cases, is(Class::Unknown, 1), unexplained), 0.9, 1});
    list.push_back({"unknown, strength 1 and above: given a wrong name",
                    counted(cases, is(Class::Unknown, 1), said("named")), 0, 0.05});
    list.push_back(
        {"near misses: named of a wrong family",
         counted(cases, is(Class::NearMiss, 0), [](const Outcome& one) { return one.wrong_family; }), 0,
         0.05});
    list.push_back(
        {"nothing hidden: false alarms",
         counted(cases, is(Class::Null, 0), [](const Outcome& one) { return one.said != "no_effect"; }), 0,
         0.05, 0.08});
    list.push_back({"errors of what went in: given a wrong name",
                    counted(cases, is(Class::NoisyInput, 0), said("named")), 0, 0.05, 0.05});
    list.push_back({"known, strength 1 to 2: named first", counted(cases, band(1, 2), right), 0.9, 1});
    list.push_back(
        {"known, strength 4 and above: named first", counted(cases, band(4, 1e9), right), 0.97, 1});
    int covered = 0, all = 0;
    std::map<std::string, std::pair<int, int>> by_kind;
    for (const Outcome& one : cases) {
        if (one.ranks.empty()) continue;
        const int parameters = static_cast<int>(one.ranks.size());
        covered += one.covered;
        all += parameters;
        by_kind[one.kind].first += one.covered;
        by_kind[one.kind].second += parameters;
    }
    list.push_back({"90 % intervals that hold the true parameter", rate_of(covered, all), 0.85, 0.95});
    for (const auto& [kind, count] : by_kind)
        list.push_back(
            {fmt::format("90 % intervals of {}", kind), rate_of(count.first, count.second), 0.85, 0.95});
    return list;
}

std::array<int, 10> rank_histogram(const std::vector<Outcome>& cases) {
    std::array<int, 10> bins{};
    for (const Outcome& one : cases)
        for (const double rank : one.ranks)
            ++bins[static_cast<std::size_t>(std::clamp(rank * 10, 0.0, 9.0))];
    return bins;
}

double uniformity(const std::array<int, 10>& histogram) {
    double all = 0.0, sum = 0.0;
    for (const int count : histogram)
        all += count;
    if (!(all > 0)) return 1.0;
    constexpr double kBins = 10;
    const double expected = all / kBins;
    for (const int count : histogram)
        sum += (count - expected) * (count - expected) / expected;
    return stats::gamma_tail((kBins - 1) / 2, sum / 2);
}

}  // namespace puckloop::gap::selftest::grammar
