#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

namespace puckloop::gap::stats {

namespace {

struct GroupMeans {
    std::map<int, double> sum, count;

    void add(double label, double y) {
        const int key = static_cast<int>(std::lround(label));
        sum[key] += y;
        count[key] += 1;
    }
};

/// Labels of units that mix two groups (a run mean over both) go to the nearer one.
Finding compared(const Series& residual, const std::vector<double>& label, std::string_view test,
                 std::string_view name, const std::vector<std::string>& label_names,
                 const TestOptions& options) {
    Finding finding{.test = std::string(test), .covariate = std::string(name)};
    Pairs pairs = prepared(residual, label);
    pairs.y = winsorised(pairs.y);
    GroupMeans observed;
    for (std::size_t i = 0; i < pairs.size(); ++i)
        observed.add(pairs.x[i], pairs.y[i]);
    finding.units = static_cast<double>(pairs.blocks.size());
    if (observed.count.size() < 2) return not_asked(finding, fmt::format("one {} only", name));
    if (pairs.blocks.size() < observed.count.size() + 2)
        return not_asked(finding, fmt::format("too few runs or blocks for {}", name));
    const double centre = mean(pairs.y);
    const auto between = [&](const std::vector<double>& y) {
        GroupMeans means;
        for (std::size_t i = 0; i < y.size(); ++i)
            means.add(pairs.x[i], y[i] - centre);
        double total = 0;
        for (const auto& [key, sum] : means.sum)
            total += sum * sum / means.count[key];
        return total;
    };
    double all = 0;
    for (const double y : pairs.y)
        all += (y - centre) * (y - centre);
    finding.statistic = all > 0 ? between(pairs.y) / all : 0.0;
    finding.p = permutation_p(pairs, between, options, fmt::format("{}/{}", test, name));
    int low = observed.sum.begin()->first, high = low;
    const auto mean_of = [&](int key) { return observed.sum[key] / observed.count[key]; };
    for (const auto& entry : observed.sum) {
        if (mean_of(entry.first) < mean_of(low)) low = entry.first;
        if (mean_of(entry.first) > mean_of(high)) high = entry.first;
    }
    finding.effect = mean_of(high) - mean_of(low);
    const double scale = robust_scale(residual.value);
    finding.relative = scale > 0 ? finding.effect / scale : 0.0;
    const auto called = [&](int key) {
        const auto index = static_cast<std::size_t>(key);
        return key >= 0 && index < label_names.size() ? label_names[index] : std::to_string(key);
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
