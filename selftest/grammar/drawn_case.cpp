#include "selftest/grammar/drawn_case.h"

#include "gap/stats/exchange.h"
#include "selftest/benches/rig.h"
#include "selftest/case_list.h"
#include "selftest/grammar/laboratory.h"
#include "selftest/grammar/near_misses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <span>

namespace puckloop::gap::selftest::grammar {

namespace {

constexpr std::size_t kDesigns =
    4;  // of a kind, in one run: examples of known effects are made once for each
constexpr int kMostDraws = 200;
constexpr double kWeakest = 0.5, kStrongest = 8.0;  // over noise
constexpr double kMostAmplitude = 50;

using Examples = std::vector<std::vector<WrittenExperiment>>;

/// Effects of the catalogue as the self test makes them in a design.
struct Known {
    std::vector<int> numbers;
    Examples examples;
};

/// What the catalogue's effects do to a design; made when first asked for.
std::shared_ptr<const Known> examples_of(std::size_t bench, std::uint64_t design) {
    static std::mutex mutex;
    static std::map<std::pair<std::size_t, std::uint64_t>, std::shared_ptr<const Known>> known;
    const std::lock_guard lock(mutex);
    auto& place = known[{bench, design}];
    if (!place) {
        auto made = std::make_shared<Known>();
        const auto effects = benches()[bench]->effects();
        for (std::size_t e = 0; e < effects.size(); ++e)
            if (effects[e].number != 0 && effects[e].instead_of == 0) {
                made->numbers.push_back(effects[e].number);
                made->examples.push_back(benches()[bench]->examples(e, design));
            }
        place = std::move(made);
    }
    return place;
}

double drawn_strength(RandomStream& random) {
    return kWeakest * std::pow(kStrongest / kWeakest, random.uniform());
}

/// Losses at one rate in all rows are in the catalogue: their share of what a field does.
double evenness(const Field& field) {
    double sum = 0.0, count = 0.0;
    for (const auto& run : field.value)
        for (const double v : run) {
            sum += std::abs(v);
            count += 1;
        }
    return std::pow(sum / count, 2);  // the mean square is 1
}

void note_likeness(DrawnCase& drawn, const WrittenExperiment& with, const WrittenExperiment& exact,
                   const Known& known, const std::vector<NoiseFloor>& floor) {
    const auto shares = likenesses_of(with, exact, known.examples, floor);
    drawn.likeness = 0.0;
    drawn.alike.clear();
    for (std::size_t e = 0; e < shares.size(); ++e) {
        drawn.likeness = std::max(drawn.likeness, shares[e]);
        if (shares[e] > kMostLikeness) drawn.alike.push_back(known.numbers[e]);
    }
}

void draw_unknown(DrawnCase& drawn, const WrittenExperiment& exact, std::size_t bench, std::uint64_t design,
                  RandomStream& random) {
    const auto covariates = covariates_of(exact);
    const auto sites = sites_of(exact.kind);
    const auto floor = benches()[bench]->floor();
    const auto known = examples_of(bench, design);
    for (;; ++drawn.redrawn) {
        const Site site = sites[random.below(sites.size())];
        const Field field = drawn_field(exact, covariates, random);
        const RandomStream chance(random.next(), "chance");
        const double a = amplitude_for(exact, site, field, drawn.asked, floor, chance, drawn.hidden.ratio);
        WrittenExperiment with = with_effect(exact, site, field, a, chance);
        if (site.how == Site::How::Lost)
            drawn.likeness = evenness(field);
        else
            note_likeness(drawn, with, exact, *known, floor);
        const bool strong = drawn.hidden.ratio > 0.8 * drawn.asked;
        if ((strong && drawn.likeness <= kMostLikeness) || drawn.redrawn >= kMostDraws) {
            drawn.text = site.text() + field.text;
            drawn.hidden.experiment = std::move(with);
            return;
        }
    }
}

void draw_near_miss(DrawnCase& drawn, const WrittenExperiment& exact, std::size_t bench, std::uint64_t design,
                    RandomStream& random) {
    for (;; ++drawn.redrawn) {
        const NearMiss miss = drawn_near_miss(exact, random);
        const RandomStream chance(random.next(), "chance");
        const double a = amplitude_for(exact, miss.site, miss.field, drawn.asked, benches()[bench]->floor(),
                                       chance, drawn.hidden.ratio);
        if (drawn.hidden.ratio < 0.8 * drawn.asked && drawn.redrawn < kMostDraws) continue;
        drawn.text = miss.text;
        drawn.family = miss.family;
        drawn.hidden.experiment = with_effect(exact, miss.site, miss.field, a, chance);
        note_likeness(drawn, drawn.hidden.experiment, exact, *examples_of(bench, design),
                      benches()[bench]->floor());
        return;
    }
}

/// An effect of the catalogue, by the self test's own models.
void draw_known(DrawnCase& drawn, std::size_t bench, std::size_t least_runs, RandomStream& random) {
    const auto effects = benches()[bench]->effects();
    std::size_t one = random.below(effects.size());
    while (effects[one].number == 0 || effects[one].instead_of != 0)
        one = random.below(effects.size());
    CasePlan plan{bench, {one}, Strength::Medium, Expect::Named, random.next()};
    plan.asked = drawn.asked;
    plan.least_runs = least_runs;
    drawn.hidden = benches()[bench]->make(plan);
    drawn.text = effects[one].label;
}

}  // namespace

const char* class_name(Class of) {
    constexpr const char* names[] = {"null", "known", "near miss", "unknown", "noisy input"};
    return names[static_cast<int>(of)];
}

std::vector<NoiseFloor> floor_of(const std::string& kind) {
    for (const auto& bench : benches())
        if (bench->kind() == kind) return bench->floor();
    return {};
}

double amplitude_for(const WrittenExperiment& exact, const Site& site, const Field& field, double asked,
                     const std::vector<NoiseFloor>& floor, const RandomStream& chance, double& reached) {
    double a = 0.05;
    constexpr int kSteps = 12;
    for (int step = 0; step < kSteps; ++step) {
        reached = distance_in_noise(with_effect(exact, site, field, a, chance), exact, floor);
        if (!(reached > 0) || std::abs(reached - asked) < 0.02 * asked) break;
        const double power =
            site.how == Site::How::Lost ? 2.0 : 1.0;  // strength is the root of the share lost
        a = std::min(a * std::pow(std::clamp(asked / reached, 0.1, 10.0), power), kMostAmplitude);
    }
    return a;
}

std::vector<double> likenesses_of(const WrittenExperiment& with, const WrittenExperiment& rest,
                                  const Examples& examples, const std::vector<NoiseFloor>& floor) {
    std::size_t runs = rest.runs.size();  // of a longer experiment the first design's
    for (const auto& effect : examples)
        for (const WrittenExperiment& example : effect)
            runs = std::min(runs, example.runs.size());
    const auto difference = [&](const WrittenExperiment& one) {
        std::vector<double> all;
        for (const NoiseFloor& noise : floor)
            for (std::size_t r = 0; r < runs; ++r)
                for (const double d : difference_in_noise(one.runs[r], rest.runs[r], noise))
                    all.push_back(std::isfinite(d) ? d : 0.0);
        return all;
    };
    const auto product = [](const std::vector<double>& a, const std::vector<double>& b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i)
            sum += a[i] * b[i];
        return sum;
    };
    const std::vector<double> whole = difference(with);
    const double size = product(whole, whole);
    if (!(size > 0)) return std::vector<double>(examples.size(), 1.0);
    std::vector<double> shares;
    for (const auto& effect : examples) {
        std::vector<std::vector<double>> basis;  // orthonormal
        double made = 0.0;
        for (const WrittenExperiment& example : effect) {
            std::vector<double> v = difference(example);
            const double before = product(v, v);
            for (const auto& b : basis) {
                const double share = product(v, b);
                for (std::size_t i = 0; i < v.size(); ++i)
                    v[i] -= share * b[i];
            }
            const double length = product(v, v);
            if (!(length > 1e-6 * before)) continue;
            for (double& x : v)
                x /= std::sqrt(length);
            made += std::pow(product(whole, v), 2);
            basis.push_back(std::move(v));
        }
        shares.push_back(made / size);
    }
    return shares;
}

Class class_of(std::size_t number) {
    constexpr std::array kTurns{Class::Unknown, Class::NearMiss, Class::Known, Class::Null};
    return kTurns[number / benches().size() % kTurns.size()];
}

DrawnCase drawn_case(std::size_t number, std::uint64_t seed, bool draw_runs, std::size_t least_runs) {
    const std::size_t bench = number % benches().size();
    RandomStream random(seed, fmt::format("grammar case {}", number));
    Laboratory laboratory = Laboratory::draw(random);
    laboratory.one_pass = laboratory.one_pass && least_runs == 0;
    if (draw_runs) laboratory.fewer.emplace(seed, fmt::format("runs of case {}", number));
    DrawnCase drawn;
    drawn.of = class_of(number);
    drawn.asked = drawn.of == Class::Null ? 0.0 : drawn_strength(random);
    if (drawn.of == Class::Known) {
        draw_known(drawn, bench, least_runs, random);
        laboratory.plan(drawn.hidden.experiment);  // every pass has every condition
    } else {
        const std::uint64_t design =
            RandomStream(seed, fmt::format("design {} {}", bench, random.below(kDesigns))).next();
        WrittenExperiment exact =
            repeated(design, least_runs, [&](std::uint64_t one) { return benches()[bench]->exact(one); });
        laboratory.plan(exact);
        drawn.hidden.kind = benches()[bench]->kind();
        drawn.hidden.experiment = exact;
        if (drawn.of == Class::Unknown) draw_unknown(drawn, exact, bench, design, random);
        if (drawn.of == Class::NearMiss) draw_near_miss(drawn, exact, bench, design, random);
        RandomStream style(seed, fmt::format("noise style {}", number));
        benches()[bench]->measure(drawn.hidden.experiment, NoiseStyle::draw(style), random.next());
        drawn.hidden.expect = drawn.of == Class::Null ? Expect::NoEffect : Expect::Unexplained;
    }
    laboratory.keep(drawn.hidden.experiment);
    drawn.text += laboratory.text();
    drawn.runs = drawn.hidden.experiment.runs.size();
    return drawn;
}

DrawnCase with_runs(const DrawnCase& drawn, std::size_t count, std::uint64_t seed) {
    std::vector<std::size_t> order(drawn.runs);
    std::iota(order.begin(), order.end(), std::size_t{0});
    RandomStream random(seed, "runs that are left");
    stats::shuffle(std::span(order), random);
    order.resize(std::min(count, order.size()));
    std::sort(order.begin(), order.end());
    DrawnCase fewer = drawn;
    fewer.hidden.experiment.runs.clear();
    for (const std::size_t run : order)
        fewer.hidden.experiment.runs.push_back(drawn.hidden.experiment.runs[run]);
    fewer.runs = order.size();
    return fewer;
}

}  // namespace puckloop::gap::selftest::grammar
