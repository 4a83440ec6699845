#include "gap/stats/noise_floor.h"

#include "gap/stats/robust.h"

#include <cmath>
#include <limits>
#include <map>

namespace puckloop::gap::stats {

namespace {
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSecondDifference = 6.0;  // variance of y[i-1] - 2 y[i] + y[i+1] of white noise
constexpr double kSameShare = 1e-9;        // of a covariate's range

/// Standard deviation that several groups have in common; NaN where none has two values.
struct Pooled {
    double squares = 0.0, freedom = 0.0;

    void add(const std::vector<double>& group) {
        if (group.size() < 2) return;
        const double own = static_cast<double>(group.size() - 1);
        squares += own * std::pow(standard_deviation(group), 2);
        freedom += own;
    }
    double deviation() const { return freedom > 0 ? std::sqrt(squares / freedom) : kNan; }
};

}  // namespace

NoiseFloor noise_floor(const Series& measured, const std::vector<int>& stimulus) {
    std::map<int, std::map<int, std::vector<double>>> values;  // by stimulus, then run
    for (std::size_t i = 0; i < measured.size(); ++i)
        if (std::isfinite(measured.value[i]) && stimulus[i] >= 0)
            values[stimulus[i]][measured.run[i]].push_back(measured.value[i]);
    NoiseFloor floor{kNan, kNan, kNan};
    Pooled within, between;
    for (const auto& [number, by_run] : values) {
        std::vector<double> means;
        for (const auto& [run, list] : by_run) {
            means.push_back(mean(list));
            within.add(list);
            if (list.size() > 1) floor.repeats += list.size();
        }
        between.add(means);
        if (means.size() > 1) ++floor.stimuli_in_runs;
    }
    floor.within_run = within.deviation();
    floor.between_runs = between.deviation();
    std::vector<double> second;
    for (std::size_t i = 2; i < measured.size(); ++i)
        if (measured.run[i] == measured.run[i - 2])
            second.push_back(measured.value[i] - 2 * measured.value[i - 1] + measured.value[i - 2]);
    if (second.size() >= 8) floor.differences = robust_scale(second) / std::sqrt(kSecondDifference);
    return floor;
}

std::vector<int> stimulus_numbers(const std::vector<std::vector<double>>& covariates) {
    if (covariates.empty()) return {};
    std::map<std::vector<long long>, int> known;
    std::vector<int> number(covariates.front().size(), -1);
    std::vector<double> lowest, quantum;
    for (const auto& c : covariates) {
        lowest.push_back(quantile(c, 0));
        quantum.push_back(std::max((quantile(c, 1) - lowest.back()) * kSameShare, 1e-300));
    }
    for (std::size_t i = 0; i < number.size(); ++i) {
        std::vector<long long> key;
        bool complete = true;
        for (std::size_t c = 0; c < covariates.size() && complete; ++c) {
            complete = std::isfinite(covariates[c][i]);
            if (complete) key.push_back(std::llround((covariates[c][i] - lowest[c]) / quantum[c]));
        }
        if (complete) number[i] = known.emplace(key, static_cast<int>(known.size())).first->second;
    }
    return number;
}

}  // namespace puckloop::gap::stats
