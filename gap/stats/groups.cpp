#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace puckloop::gap::stats {

namespace {

/// Which group each value belongs to, from 0.
struct Groups {
    std::vector<int> of;
    std::vector<double> count;

    Groups(std::vector<int> numbers, std::size_t groups) : of(std::move(numbers)), count(groups, 0.0) {
        for (const int group : of)
            count[static_cast<std::size_t>(group)] += 1;
    }
    std::vector<double> sums(const std::vector<double>& y, double centre) const {
        std::vector<double> sum(count.size(), 0.0);
        for (std::size_t i = 0; i < y.size(); ++i)
            sum[static_cast<std::size_t>(of[i])] += y[i] - centre;
        return sum;
    }
    /// Of the squares about `centre`, those that lie between groups.
    double between(const std::vector<double>& y, double centre) const {
        double total = 0;
        const std::vector<double> sum = sums(y, centre);
        for (std::size_t g = 0; g < sum.size(); ++g)
            if (count[g] > 0) total += sum[g] * sum[g] / count[g];
        return total;
    }
};

/// Takes the share of variance between groups and its p.
void judge(const Pairs& pairs, const Groups& groups, const TestOptions& options, std::string_view stream,
           Finding& finding) {
    const double centre = mean(pairs.y);
    const auto between = [&](const std::vector<double>& y) { return groups.between(y, centre); };
    double all = 0;
    for (const double y : pairs.y)
        all += (y - centre) * (y - centre);
    finding.statistic = all > 0 ? between(pairs.y) / all : 0.0;
    finding.p = permutation_p(pairs, between, options, stream);
}

/// Labels of units that mix two groups (a run mean over both) go to the nearer one.
Finding compared(const Series& residual, const std::vector<double>& label, std::string_view test,
                 std::string_view name, const std::vector<std::string>& label_names,
                 const TestOptions& options) {
    Pairs pairs = prepared(residual, label);
    pairs.y = pulled_in(residual, pairs.y);
    Finding finding = begun(test, name, pairs);
    std::map<long, int> number;
    for (const double one : pairs.x)
        number[std::lround(one)] = 0;
    std::vector<long> key;
    for (auto& [label_of, place] : number) {
        place = static_cast<int>(key.size());
        key.push_back(label_of);
    }
    if (key.size() < 2) return not_asked(finding, fmt::format("one {} only", name));
    if (pairs.blocks.size() < key.size() + 2)
        return not_asked(finding, fmt::format("too few runs or blocks for {}", name));
    std::vector<int> group;
    for (const double one : pairs.x)
        group.push_back(number[std::lround(one)]);
    const Groups groups(std::move(group), key.size());
    judge(pairs, groups, options, fmt::format("{}/{}", test, name), finding);
    std::vector<double> means = groups.sums(pairs.y, 0.0);
    for (std::size_t g = 0; g < means.size(); ++g)
        means[g] /= groups.count[g];
    const auto low = std::ranges::min_element(means), high = std::ranges::max_element(means);
    finding.effect = *high - *low;
    finding.relative = beside_scatter(finding.effect, residual);
    const auto called = [&](auto at) {
        const long one = key[static_cast<std::size_t>(at - means.begin())];
        const auto index = static_cast<std::size_t>(one);
        return one >= 0 && index < label_names.size() ? label_names[index] : std::to_string(one);
    };
    finding.shape = fmt::format("differs by {}: highest {}, lowest {}", name, called(high), called(low));
    return finding;
}

}  // namespace

Finding group_test(const Series& residual, const std::vector<int>& label, std::string_view name,
                   const std::vector<std::string>& label_names, const TestOptions& options) {
    return compared(residual, std::vector<double>(label.begin(), label.end()), "group", name, label_names,
                    options);
}

Finding shape_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    Pairs pairs = prepared(residual, covariate);
    Finding finding = begun("shape", name, pairs);
    if (pairs.size() < kLeastUnits) return too_few(finding, pairs);
    pairs.y = pulled_in(residual, pairs.y);
    int count = 0;
    std::vector<int> bin = bins_of(pairs.x, count);
    judge(pairs, {std::move(bin), static_cast<std::size_t>(count)}, options, fmt::format("shape/{}", name),
          finding);
    const Profile profile = profile_of(pairs.x, pairs.y);
    finding.effect = profile.range();
    finding.relative = beside_scatter(finding.effect, residual);
    finding.shape = shape_words(profile, name);
    return finding;
}

Finding reversal_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                      std::size_t rows, const TestOptions& options) {
    std::vector<double> after(residual.size(), 0.0);
    std::size_t left = 0;
    double last_sign = 0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
        if (i == 0 || residual.run[i] != residual.run[i - 1]) left = 0, last_sign = 0;
        const double sign = covariate[i] > 0 ? 1.0 : covariate[i] < 0 ? -1.0 : 0.0;
        if (sign != 0 && last_sign != 0 && sign != last_sign) left = rows;
        if (sign != 0) last_sign = sign;
        if (left > 0) after[i] = last_sign > 0 ? 2.0 : 1.0, --left;
    }
    return compared(residual, after, "reversal", fmt::format("reversal of {}", name),
                    {"elsewhere", "after turning negative", "after turning positive"}, options);
}

}  // namespace puckloop::gap::stats
