#include "gap/stats/noise_floor.h"

#include "gap/stats/robust.h"

#include <cmath>
#include <map>
#include <utility>

namespace puckloop::gap::stats {

namespace {
constexpr double kSecondDifference = 6.0;  // variance of y[i-1] - 2 y[i] + y[i+1] of white noise
}  // namespace

NoiseFloor noise_floor(const Series& measured, const std::vector<int>& stimulus) {
    std::map<int, std::map<int, std::vector<double>>> values;  // by stimulus, then run
    for (std::size_t i = 0; i < measured.size(); ++i)
        if (std::isfinite(measured.value[i]) && stimulus[i] >= 0)
            values[stimulus[i]][measured.run[i]].push_back(measured.value[i]);
    NoiseFloor floor{NAN, NAN};
    double squares = 0, freedom = 0, between_squares = 0, between_freedom = 0;
    for (const auto& [number, by_run] : values) {
        std::vector<double> means;
        for (const auto& [run, list] : by_run) {
            means.push_back(mean(list));
            if (list.size() < 2) continue;
            const double f = static_cast<double>(list.size() - 1);
            squares += f * std::pow(standard_deviation(list), 2);
            freedom += f;
        }
        if (means.size() < 2) continue;
        const double f = static_cast<double>(means.size() - 1);
        between_squares += f * std::pow(standard_deviation(means), 2);
        between_freedom += f;
    }
    if (freedom > 0) floor.within_run = std::sqrt(squares / freedom);
    if (between_freedom > 0) floor.between_runs = std::sqrt(between_squares / between_freedom);
    return floor;
}

double row_to_row(const Series& left, const std::vector<int>& chain) {
    constexpr std::size_t kFewest = 8;
    std::map<std::pair<int, int>, std::vector<double>> chains;
    for (std::size_t i = 0; i < left.size(); ++i)
        chains[{left.run[i], chain[i]}].push_back(left.value[i]);
    std::vector<double> second;
    for (const auto& [key, values] : chains)
        for (std::size_t i = 2; i < values.size(); ++i)
            second.push_back(values[i] - 2 * values[i - 1] + values[i - 2]);
    return second.size() < kFewest ? NAN : robust_scale(second) / std::sqrt(kSecondDifference);
}

std::vector<int> stimulus_numbers(const std::vector<std::vector<double>>& covariates, double same) {
    if (covariates.empty()) return {};
    std::map<std::vector<long long>, int> known;
    std::vector<int> number(covariates.front().size(), -1);
    std::vector<double> lowest, quantum;
    for (const auto& c : covariates) {
        lowest.push_back(quantile(c, 0));
        quantum.push_back(std::max((quantile(c, 1) - lowest.back()) * same, 1e-300));
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
