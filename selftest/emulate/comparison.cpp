#include "selftest/emulate/comparison.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace puckloop::gap::emulate {

void Comparison::error(double difference) {
    if (std::isnan(difference)) return;
    squares_ += difference * difference;
    ++errors_;
}

void Comparison::add(std::vector<Weighted>& to, double value, double weight) {
    if (!std::isnan(value)) to.push_back({value, weight});
}

void Comparison::measured(double value, double weight) {
    add(measured_, value, weight);
}

void Comparison::performed(double value, double weight) {
    add(performed_, value, weight);
}

std::optional<double> Comparison::off_by() const {
    if (errors_ > 0) return std::sqrt(squares_ / static_cast<double>(errors_));
    if (measured_.empty() || performed_.empty()) return std::nullopt;
    // Both distribution functions rise to 1: each value adds its share, of what was performed negative.
    std::vector<Weighted> steps;
    const auto take = [&](const std::vector<Weighted>& all, double sign) {
        double sum = 0.0;
        for (const Weighted& one : all)
            sum += one.weight;
        std::transform(all.begin(), all.end(), std::back_inserter(steps), [&](const Weighted& one) {
            return Weighted{one.value, sign * one.weight / sum};
        });
    };
    take(measured_, 1.0);
    take(performed_, -1.0);
    std::sort(steps.begin(), steps.end(),
              [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
    double area = 0.0, apart = 0.0;
    for (std::size_t k = 0; k + 1 < steps.size(); ++k) {
        apart += steps[k].weight;
        area += std::abs(apart) * (steps[k + 1].value - steps[k].value);
    }
    return area;
}

Floor floor_of(const std::vector<double>& errors) {
    constexpr double kShare = 0.95;
    Floor floor;
    const auto n = static_cast<double>(errors.size());
    for (const double error : errors)
        floor.mean += error / n;
    floor.limit = floor.mean;
    if (errors.size() < 2) return floor;
    double squares = 0.0;
    for (const double error : errors)
        squares += std::pow(error - floor.mean, 2);
    floor.limit += stats::student_quantile(kShare, n - 1) * std::sqrt(squares / (n - 1) * (1 + 1 / n));
    return floor;
}

}  // namespace puckloop::gap::emulate
