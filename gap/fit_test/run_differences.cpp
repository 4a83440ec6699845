#include "gap/fit_test/run_differences.h"

#include "gap/evidence/criterion.h"
#include "gap/findings/quantities.h"
#include "gap/fit_test/scores.h"
#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"
#include "gap/stats/tails.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kLeastRuns = 3;
constexpr std::size_t kBatches = 6;    // of a run: batch means (Schmeiser 1982: few and long ones)
constexpr std::size_t kBatchRows = 4;  // at least
constexpr double kLeastSpread = 0.25;  // of the scores, in units of what the noise model expects
constexpr int kGrid = 60;              // values of tau
constexpr double kSameShape = 0.999;   // correlation of two modes that are one

/// A number as one run, or one batch of it, has it: score and information.
struct Score {
    double g = 0.0, h = 0.0;
};

/// A number as one run has it, with a variance where runs differ by nothing but what the simulator draws.
struct Estimate {
    double value = 0.0, variance = 0.0;
};

struct Mode {
    const char* what;
    std::string unit;
    std::vector<double> shift;
};

std::vector<Mode> modes_of(const Observable& o, const Predicted& p) {
    const std::size_t n = o.y.size();
    std::vector<Mode> modes;
    if (!adds_up(o)) modes.push_back({"offset", o.unit, std::vector<double>(n, 1.0)});
    if (o.noise == NoiseKind::Event) {
        modes.front().unit = "logits";  // said as shares of rows: how_runs_differ()
        return modes;
    }
    Mode share{"share of what is predicted", kShare, p.mean};
    if (adds_up(o)) {
        Mode drift{"drift", o.unit + "/s", std::vector<double>(n, 0.0)};
        for (const stats::Stretch& run : stats::stretches_of(o.run))
            for (std::size_t i = run.first; i < run.last; ++i) {
                share.shift[i] -= p.mean[run.first];
                if (!o.time.empty()) drift.shift[i] = o.time[i] - o.time[run.first];
            }
        modes.push_back(std::move(drift));
    }
    modes.push_back(std::move(share));
    return modes;
}

/// A number as each run has it, by how far scores scatter inside runs.
struct ByRun {
    std::vector<Estimate> run;
    double freedom = 0.0;  ///< of how far they scatter
};

/// What the simulator draws once a run does to each run's score: variance.
std::map<std::uint32_t, double> known_variance(const Observable& o, const Scores& scores,
                                               const std::vector<double>& answers,
                                               const std::vector<std::vector<double>>& drawn) {
    std::map<std::uint32_t, double> variance;
    for (const auto& one : drawn) {
        std::map<std::uint32_t, double> g;
        for (std::size_t i = 0; i < o.y.size(); ++i)
            g[o.run[i]] += answers[i] * one[i] * scores.curvature();
        for (const auto& [run, score] : g)
            variance[run] += score * score / static_cast<double>(drawn.size());
    }
    return variance;
}

/// `drawn`: how the scores answer to what the simulator draws once a run.
ByRun by_run(const Observable& o, const Scores& scores, const std::vector<double>& answers,
             const std::vector<std::vector<double>>& drawn) {
    auto known = known_variance(o, scores, answers, drawn);
    std::map<std::uint32_t, std::size_t> rows, seen;
    for (const auto run : o.run)
        ++rows[run];
    std::map<std::uint32_t, std::vector<Score>> batches;
    for (std::size_t i = 0; i < o.y.size(); ++i) {
        const std::size_t count = std::clamp<std::size_t>(rows[o.run[i]] / kBatchRows, 1, kBatches);
        auto& of_run = batches[o.run[i]];
        of_run.resize(count);
        Score& batch = of_run[seen[o.run[i]]++ * count / rows[o.run[i]]];
        batch.g += answers[i] * scores.pull()[i];
        batch.h += answers[i] * answers[i] * scores.curvature();
    }
    std::map<std::uint32_t, Score> sums;
    double within = 0.0, freedom = 0.0;
    for (const auto& [run, of_run] : batches) {
        Score sum;
        double squares = 0.0, informed = 0.0;
        for (const Score& one : of_run) {
            if (!(one.h > 0)) continue;
            sum.g += one.g;
            sum.h += one.h;
            squares += one.g * one.g / one.h;
            informed += 1;
        }
        if (!(sum.h > 0)) continue;
        sums[run] = sum;
        within += squares - sum.g * sum.g / sum.h;
        freedom += informed - 1;
    }
    // How much wider than expected scores scatter inside runs.
    const double spread = freedom > 0 ? std::max(within / freedom, kLeastSpread) : 1.0;
    ByRun result{{}, freedom};
    for (const auto& [run, sum] : sums)
        result.run.push_back({sum.g / sum.h, spread / sum.h + known[run] / (sum.h * sum.h)});
    return result;
}

double log_normal(double x, double variance) {
    return -0.5 * (std::log(2 * std::numbers::pi * variance) + x * x / variance);
}

/// Estimates of the runs, all but one, about a common mean with tau between them.
struct Common {
    double mean = 0.0, log_likelihood = 0.0;
};
Common common_of(const std::vector<Estimate>& runs, double tau, std::size_t left_out) {
    double weights = 0.0, sum = 0.0;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        if (r == left_out) continue;
        const double weight = 1 / (tau * tau + runs[r].variance);
        weights += weight;
        sum += weight * runs[r].value;
    }
    Common result{sum / weights, 0.0};
    for (std::size_t r = 0; r < runs.size(); ++r)
        if (r != left_out)
            result.log_likelihood += log_normal(runs[r].value - result.mean, tau * tau + runs[r].variance);
    return result;
}

double best_tau(const std::vector<Estimate>& runs, std::size_t left_out) {
    std::vector<double> doubts;
    for (const Estimate& run : runs)
        doubts.push_back(std::sqrt(run.variance));
    const double unit = stats::median(doubts);
    double best = 0.0, most = common_of(runs, 0.0, left_out).log_likelihood;
    for (int k = 0; k < kGrid; ++k) {
        const double tau = unit * std::pow(10.0, -1 + 5.0 * k / (kGrid - 1));
        const double one = common_of(runs, tau, left_out).log_likelihood;
        if (one > most) most = one, best = tau;
    }
    return best;
}

/// Of an event: in which share of their rows it happens, in the run where it is rarest and in the other.
std::string shares_of(const Observable& o) {
    std::map<std::uint32_t, std::pair<double, double>> by_run;  // happened, of rows
    for (std::size_t i = 0; i < o.y.size(); ++i)
        by_run[o.run[i]].first += o.y[i], by_run[o.run[i]].second += 1;
    double low = INFINITY, high = -INFINITY;
    for (const auto& [run, count] : by_run) {
        low = std::min(low, count.first / count.second);
        high = std::max(high, count.first / count.second);
    }
    return fmt::format("happens in {} to {} of a run's rows", quantity(low, kShare), quantity(high, kShare));
}

/// `step`: what is smaller, in the observable's unit, is no difference.
RunDifference difference_of(const Observable& o, const Mode& mode, const ByRun& scores, double step) {
    const auto& runs = scores.run;
    const std::size_t n = runs.size();
    RunDifference result;
    result.observable = o.name;
    std::vector<double> gains;
    for (std::size_t r = 0; r < n; ++r) {
        const double tau = best_tau(runs, r), own = runs[r].variance;
        const double random = runs[r].value - common_of(runs, tau, r).mean,
                     fixed = runs[r].value - common_of(runs, 0.0, r).mean;
        gains.push_back(log_normal(random, tau * tau + own) - log_normal(fixed, own));
    }
    const Gain gain = gain_of(gains);
    result.gain = gain.sum;
    result.sd = gain.sd;
    const double middle = common_of(runs, 0.0, n).mean;
    double between = 0.0, low = INFINITY, high = -INFINITY;
    for (const Estimate& run : runs) {
        between += std::pow(run.value - middle, 2) / run.variance;
        low = std::min(low, run.value);
        high = std::max(high, run.value);
    }
    const auto freedom = static_cast<double>(n - 1);
    const double reach =
        std::max(std::ranges::max(mode.shift), 0.0) - std::min(std::ranges::min(mode.shift), 0.0);
    if ((high - low) * reach < step) {
        result.gain = 0.0;
        return result;
    }
    if (scores.freedom > 0) result.p_value = stats::fisher_tail(between / freedom, freedom, scores.freedom);
    result.shape =
        o.noise == NoiseKind::Event
            ? fmt::format("differs from run to run: {}", shares_of(o))
            : fmt::format("differs from run to run: {} {} to {} (sd {})", mode.what, change(low, mode.unit),
                          change(high, mode.unit), quantity(best_tau(runs, n), mode.unit));
    return result;
}

}  // namespace

std::vector<RunDifference> run_differences(const Model& model, const State& state) {
    const Prediction prediction = model.predicted(state.values);
    std::vector<RunDifference> all;
    for (std::size_t k = 0; k < model.observables().size(); ++k) {
        const Observable& o = model.observables()[k];
        if (o.fixed_sd > 0 || o.y.empty() || is_rounding(o, state.noise[k])) continue;
        const Scores scores(o, prediction[k], state.noise[k]);
        std::vector<std::vector<double>> drawn, seen;
        for (const auto& one : o.run_draws)
            drawn.push_back(scores.answers(one));
        for (const Mode& mode : modes_of(o, prediction[k])) {
            auto answers = scores.answers(mode.shift);
            if (std::ranges::any_of(seen, [&](const auto& other) {
                    return std::abs(stats::correlation(other, answers)) > kSameShape;
                }))
                continue;
            const ByRun sums = by_run(o, scores, answers, drawn);
            const double step = is_within_step(o, state.noise[k]) ? o.instrument.quantum : 0.0;
            if (sums.run.size() >= kLeastRuns) all.push_back(difference_of(o, mode, sums, step));
            seen.push_back(std::move(answers));
        }
    }
    std::ranges::stable_sort(all, std::ranges::greater{}, &RunDifference::gain);
    return all;
}

}  // namespace puckloop::gap
