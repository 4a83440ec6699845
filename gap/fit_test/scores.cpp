#include "gap/fit_test/scores.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {
constexpr double kSmallStep = 1e-3;  // of a row's noise: the filter answers linearly
constexpr double kFar = 1e4;         // an innovation moved by so many steps met a clip, not a slope
}  // namespace

Scores::Scores(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise)
    : observable_(observable), predicted_(predicted), noise_(noise) {
    filter(observable, predicted, noise, filtered_);
    const bool event = observable.noise == NoiseKind::Event;
    const double nu = std::exp(noise.log_tail);
    curvature_ = event ? 1.0 : (nu + 1) / (nu + 3);
    for (std::size_t i = 0; i < observable.y.size(); ++i) {
        const double z = filtered_.z[i];
        double innovation = 0.0, pull = 0.0;
        if (filtered_.role[i] == RowRole::Event) {
            innovation = pull = ((observable.y[i] > 0.5 ? 1.0 : 0.0) - z) / std::sqrt(z * (1 - z));
        } else if (filtered_.role[i] == RowRole::Plain && std::isfinite(z)) {
            innovation = z;
            pull = (nu + 1) * z / (nu + z * z);
        }
        innovation_.push_back(innovation);
        pull_.push_back(pull);
    }
}

std::vector<double> Scores::answers(const std::vector<double>& shift) const {
    const std::size_t n = observable_.y.size();
    std::vector<double> answer(n, 0.0);
    if (observable_.noise == NoiseKind::Event) {
        for (std::size_t i = 0; i < n; ++i) {
            const double p = std::clamp(predicted_.mean[i], kLeastProbability, 1 - kLeastProbability);
            answer[i] = shift[i] * std::sqrt(p * (1 - p));
        }
        return answer;
    }
    double largest = 0.0;
    for (const double one : shift)
        largest = std::max(largest, std::abs(one));
    if (!(largest > 0)) return answer;
    const double step = kSmallStep * row_sd(observable_, predicted_, noise_, 0) / largest;
    Predicted moved = predicted_;
    for (std::size_t i = 0; i < n; ++i)
        moved.mean[i] += step * shift[i];
    Innovations after;
    filter(observable_, moved, noise_, after);
    for (std::size_t i = 0; i < n; ++i) {
        if (filtered_.role[i] != RowRole::Plain || after.role[i] != RowRole::Plain) continue;
        const double moved_by = filtered_.z[i] - after.z[i];
        if (std::isfinite(moved_by) && std::abs(moved_by) < kFar * kSmallStep) answer[i] = moved_by / step;
    }
    return answer;
}

}  // namespace puckloop::gap
