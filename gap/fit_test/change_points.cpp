// Jumps that stay. Of a sum a jump is looked for in its innovations, where its trace is the same wherever it
// lies (the noise's filter is the same), so that one look at each row is a short sum. Of a reading it is
// looked for in the errors themselves: a jump that the model lacks makes the noise's fit believe in errors
// that carry over, and such noise jumps by itself. How far errors scatter that carry over is taken from
// batches of rows against their neighbours.

#include "gap/evidence/thresholds.h"
#include "gap/findings/quantities.h"
#include "gap/fit_test/run_differences.h"
#include "gap/fit_test/scores.h"
#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

namespace puckloop::gap {

namespace {

constexpr std::size_t kTrace = 30;          // rows after which a filter has settled
constexpr std::size_t kSettledRounds = 10;  // the last of them

/// Rows of a run that follow each other.
using Chain = stats::Stretch;

/// Answers of the rows from the jump on, a jump of one deviation.
std::vector<double> trace_of(const Observable& o, const Predicted& p, const NoiseParameters& noise,
                             const Scores& scores, const Chain& longest) {
    std::vector<double> shift(o.y.size(), 0.0);
    const std::size_t at = longest.first + longest.size() / 3;
    std::fill(shift.data() + at, shift.data() + longest.last, row_sd(o, p, noise, at));
    const auto answers = scores.answers(shift);
    return {answers.data() + at, answers.data() + std::min(at + kTrace, longest.last)};
}

/// Standardised errors, far ones pulled in; 0 where a reading was clipped.
std::vector<double> errors_of(const Observable& o, const Predicted& p, const NoiseParameters& noise) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const bool clipped = o.instrument.at_end(o.y[i]);
        errors.push_back(clipped ? 0.0 : (o.y[i] - p.mean[i]) / row_sd(o, p, noise, i));
    }
    const double limit = thresholds::kJumpTrim * stats::robust_scale(errors), middle = stats::median(errors);
    if (limit > 0)
        for (double& error : errors)
            error = std::clamp(error - middle, -limit, limit);
    return errors;
}

/// How much wider batches of pulls scatter against their neighbours than the noise model expects; one jump
/// sets but one pair apart.
double spread_of(const std::vector<Chain>& chains, std::span<const double> pull, double curvature) {
    std::vector<double> squares;
    for (const Chain& chain : chains) {
        double before = 0.0;
        const std::size_t rows = chain.size() / thresholds::kJumpBatches;
        for (std::size_t b = 0; rows > 0 && b < thresholds::kJumpBatches; ++b) {
            const auto* from = pull.data() + chain.first + b * rows;
            const double sum = std::accumulate(from, from + rows, 0.0);
            if (b > 0)
                squares.push_back(std::pow(sum - before, 2) / (2 * static_cast<double>(rows) * curvature));
            before = sum;
        }
    }
    return squares.empty() ? 1.0 : std::max(stats::median(squares) / thresholds::kSquareMedian, 1.0);
}

double ln_ln(double x) {
    return std::log(std::log(x));
}

/// Chance that the highest of chains goes as high as `most` where none jumps. The maxima of chains follow a
/// Gumbel law; where their quartiles lie wider apart or higher than squares of one deviation would, it is
/// their noise that jumps, and one jump is measured by that.
double tail_of_highest(double most, std::vector<double> highest) {
    double scale = thresholds::kSquareScale, half = 0.0;
    const std::size_t n = highest.size();
    if (n >= thresholds::kJumpChains) {
        std::ranges::sort(highest);
        const double quarter = highest[n / 4], three = highest[3 * n / 4];
        half = highest[n / 2];
        scale = std::max(
            {scale, (half - quarter) / (ln_ln(4) - ln_ln(2)), (three - half) / (ln_ln(2) - ln_ln(4.0 / 3))});
    }
    const double place = std::max(half + scale * ln_ln(2), 0.0);
    return -std::expm1(-static_cast<double>(n) * std::exp(-(most - place) / scale));
}

/// Of a jump at `at`: its score and information beyond those of a number for the whole chain.
struct WindowLook {
    double g, h;
};

class Scan {
  public:
    Scan(std::span<const double> pull, double curvature, const std::vector<double>& trace)
        : pull_(pull), curvature_(curvature), trace_(trace) {
        const std::size_t n = trace.size(), from = n - std::min(kSettledRounds, n);
        for (std::size_t j = from; j < n; ++j)
            settled_ += trace[j] / static_cast<double>(n - from);
        after_.assign(pull.size() + 1, 0.0);
        for (std::size_t i = pull.size(); i-- > 0;)
            after_[i] = after_[i + 1] + pull[i];
    }

    WindowLook at(const Chain& chain, std::size_t row) const {
        const WindowLook jump = from(chain, row), whole = from(chain, chain.first);
        const std::size_t rows = chain.last - row;
        // What is common to the whole chain is no jump: projected out, as far as it lasts.
        double both = settled_ * settled_ * static_cast<double>(rows);
        for (std::size_t j = 0; j < std::min(trace_.size(), rows); ++j)
            both += (trace_[j] - settled_) * settled_;
        both *= curvature_;
        if (!(whole.h > 0)) return jump;
        return {jump.g - both / whole.h * whole.g, jump.h - both * both / whole.h};
    }

  private:
    WindowLook from(const Chain& chain, std::size_t row) const {
        const std::size_t rows = chain.last - row;
        double g = settled_ * (after_[row] - after_[chain.last]),
               h = settled_ * settled_ * static_cast<double>(rows);
        for (std::size_t j = 0; j < std::min(trace_.size(), rows); ++j) {
            g += (trace_[j] - settled_) * pull_[row + j];
            h += trace_[j] * trace_[j] - settled_ * settled_;
        }
        return {g, h * curvature_};
    }

    std::span<const double> pull_;
    double curvature_;
    const std::vector<double>& trace_;
    double settled_ = 0.0;
    std::vector<double> after_;
};

}  // namespace

std::vector<ChangePoint> change_points(const Model& model, const State& state) {
    const Prediction prediction = model.predicted(state.values);
    std::vector<ChangePoint> all;
    for (std::size_t k = 0; k < model.observables().size(); ++k) {
        const Observable& o = model.observables()[k];
        if (o.fixed_sd > 0 || o.noise == NoiseKind::Event) continue;
        if (is_rounding(o, state.noise[k])) continue;
        auto chains = stats::stretches_of(o.run, [&](std::size_t i) { return o.starts[i] != 0; });
        std::erase_if(chains, [](const Chain& one) { return one.size() < thresholds::kJumpChain; });
        if (chains.empty()) continue;
        const Chain longest = *std::ranges::max_element(chains, {}, &Chain::size);
        const bool sum = adds_up(o);
        const Scores scores(o, prediction[k], state.noise[k]);
        const auto trace =
            sum ? trace_of(o, prediction[k], state.noise[k], scores, longest) : std::vector<double>(1, 1.0);
        const auto pull = sum ? scores.pull() : errors_of(o, prediction[k], state.noise[k]);
        const double curvature = sum ? scores.curvature() : 1.0;
        const double spread = spread_of(chains, pull, curvature);
        const Scan scan(pull, curvature, trace);
        double most = 0.0;
        std::vector<double> highest;  // of each chain, over 2 ln of its rows
        ChangePoint best;
        best.observable = o.name;
        for (const Chain& chain : chains) {
            // The largest of n squares of one deviation is about 2 ln n.
            const double usual = 2 * std::log(static_cast<double>(chain.size()));
            highest.push_back(-usual);
            // How far errors scatter is known of batches: of a shorter side nothing can be said.
            const std::size_t side = std::max(thresholds::kJumpSide, chain.size() / thresholds::kJumpBatches);
            for (std::size_t i = chain.first + side; i + side <= chain.last; ++i) {
                const WindowLook look = scan.at(chain, i);
                const double square = look.h > 0 ? look.g * look.g / (spread * look.h) : 0.0;
                highest.back() = std::max(highest.back(), square - usual);
                if (best.shape.empty() || square - usual > most) {
                    most = square - usual;
                    best.run = o.run[i];
                    best.row = o.row[i];
                    best.jump = look.g / look.h * row_sd(o, prediction[k], state.noise[k], i);
                    best.shape = fmt::format(
                        "jumps by {} in run {} at {}", quantity(best.jump, o.unit), o.run[i] + 1,
                        o.time.empty() ? fmt::format("row {}", o.row[i] + 1) : quantity(o.time[i], "s"));
                }
            }
        }
        if (best.shape.empty()) continue;
        best.p_value = tail_of_highest(most, highest);
        all.push_back(std::move(best));
    }
    // One look at each observable.
    for (ChangePoint& point : all)
        point.p_value = std::min(1.0, point.p_value * static_cast<double>(all.size()));
    std::ranges::stable_sort(all, {}, &ChangePoint::p_value);
    return all;
}

}  // namespace puckloop::gap
