#include "gap/diagnostics/taken_back.h"

#include "gap/fit/noise.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace puckloop::gap {

namespace {

using Place = std::complex<double>;

/// ln of a normal density but for its constant.
double log_normal(double squared, double variance, double dimensions) {
    return -(squared / variance + dimensions * std::log(variance)) / 2;
}

/// A drive's pose as its tracker has it and as the wheels do: sums of two places and a heading, a row each.
class TakenDrive {
  public:
    TakenDrive(const Experiment& experiment, const Model& model, const State& state)
        : experiment_(experiment),
          sums_(model.observables()),
          predicted_(model.predicted(state.values)),
          state_(state),
          along_(sums_.front().name == "along") {}

    bool begins(std::size_t row) const { return sums_.front().starts[row] != 0; }
    bool same_run(std::size_t a, std::size_t b) const { return sums_.front().run[a] == sums_.front().run[b]; }

    /// ln of the likelihood of the push in row `b` where it takes the one in row `a` back, over that of any.
    double back(std::size_t a, std::size_t b) const {
        const auto rows = static_cast<double>(b - a);
        // A heading that is off while it is away leads the way that is predicted, but not the robot.
        const double off = mean_above(a, b) - (mean_above(before(a, b), a) + mean_above(b, after(a, b))) / 2;
        Place away = 0.0, way = 0.0, last = 0.0;
        for (std::size_t i = a; i <= b; ++i) {
            const double share = i == a || i == b ? 0.5 : 1.0;
            const Place wheels = step(i, true) * std::polar(1.0, -share * off);
            way += wheels;
            away += last = step(i, false) - wheels;
        }
        const double turned = above(b) - above(b - 1);
        const double place = variance(0, a) + variance(1, a), heading = variance(2, a),
                     doubt = std::norm(way) * 2 * heading / rows;
        const auto drift = [&](std::size_t o) { return std::exp(state_.noise[o].carry) * (rows + 1); };
        const double size = (scale(0, b) + scale(1, b)) / 2;
        // Pushes may be normal, wider than was fitted, or all of one length and any direction.
        const double length = std::norm(last),
                     any = std::max(log_normal(length, std::max(place + size * size, length / 2), 2),
                                    -std::log(2 * std::numbers::pi * length * place) / 2),
                     any_turn =
                         log_normal(turned * turned,
                                    std::max(2 * heading + std::pow(scale(2, b), 2), turned * turned), 1);
        return log_normal(std::norm(away), place * (2 + drift(0)) / 2 + doubt / 2, 2) - any +
               log_normal(std::pow(above(b) - above(a - 1), 2), heading * (2 + drift(2)), 1) - any_turn;
    }

  private:
    double above(std::size_t i) const { return sums_[2].y[i] - predicted_[2].mean[i]; }
    double mean_above(std::size_t from, std::size_t to) const {
        double sum = 0.0;
        for (std::size_t i = from; i < to; ++i)
            sum += above(i);
        return sum / static_cast<double>(to - from);
    }
    /// As many rows before and after as lie between, if the run has them.
    std::size_t before(std::size_t a, std::size_t b) const {
        std::size_t first = a - 1;
        while (a - first < b - a && !begins(first))
            --first;
        return first;
    }
    std::size_t after(std::size_t a, std::size_t b) const {
        std::size_t end = b + 1;
        while (end - b < b - a && end < sums_.front().y.size() && !begins(end))
            ++end;
        return end;
    }
    /// In the room, from the row before.
    Place step(std::size_t i, bool wheels) const {
        const auto change = [&](std::size_t o) {
            const auto& sum = wheels ? predicted_[o].mean : sums_[o].y;
            return sum[i] - sum[i - 1];
        };
        const Place made(change(0), change(1));
        if (!along_) return made;
        const auto& theta = experiment_.runs[sums_.front().run[i]].column("theta_rad");
        const double here = theta[sums_.front().row[i]], last = theta[sums_.front().row[i - 1]];
        return made * std::polar(1.0, last + std::remainder(here - last, 2 * std::numbers::pi) / 2);
    }
    double variance(std::size_t o, std::size_t row) const {
        return std::pow(row_sd(sums_[o], predicted_[o], state_.noise[o], row), 2);
    }
    double scale(std::size_t o, std::size_t row) const { return predicted_[o].lapse_scale[row]; }

    const Experiment& experiment_;
    const std::vector<Observable>& sums_;
    Prediction predicted_;
    const State& state_;
    bool along_;
};

}  // namespace

double taken_back(const Experiment& experiment, const Model& model, const State& state,
                  const std::vector<std::size_t>& pushed) {
    const TakenDrive drive(experiment, model, state);
    // ln of the weight of all ways to take pushes up to one: by itself, or taking back any before it in its
    // run, at even odds.
    std::vector<double> weight(1, 0.0);
    std::size_t first = 0;  // of the run
    for (std::size_t k = 0; k < pushed.size(); ++k) {
        if (k > 0 && !drive.same_run(pushed[k - 1], pushed[k])) first = k;
        double now = weight[k];
        if (k > first && !drive.begins(pushed[first])) {
            std::vector<double> ways{weight[k]};
            for (std::size_t j = first; j < k; ++j)
                ways.push_back(weight[j] + drive.back(pushed[j], pushed[k]) -
                               std::log(static_cast<double>(k - first)));
            const double most = *std::ranges::max_element(ways);
            double sum = 0.0;
            for (const double way : ways)
                sum += std::exp(way - most) / 2;
            now = most + std::log(sum);
        }
        weight.push_back(now);
    }
    return weight.back();
}

}  // namespace puckloop::gap
