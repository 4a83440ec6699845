#include "gap/frames.h"

#include "gap/counted_path.h"

#include <Eigen/Dense>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kSlowest = 5.0;    // turns of the beat in a run, at least: less is a clock's drift
constexpr double kFiner = 4.0;      // steps of frequency in one turn more over a run
constexpr double kOutlier = 6.0;    // sd: pushes and lost sight are left out
constexpr double kEvidence = 60.0;  // deviance; the largest of some thousand frequencies reaches 30 by chance
constexpr double kEvidenceBesides = 30.0;  // of a run whose frames are as long as those of the clear ones
constexpr double kLeastClear = 0.5;        // share of runs
constexpr double kAlike = 0.3;             // by how much frames of different runs may differ in length: noise
constexpr double kLongest = 0.8;           // of the time between rows: longer, and rows repeat frames
constexpr int kRounds = 5, kReach = 4;     // of the search for frequency and phase, and its width in steps

/// What tracker and counters disagree about from row to row, and what lateness would make of it: an error is
/// minus the change of rate times lateness.
struct Disagreement {
    std::vector<double> time;                  ///< s of the rows
    std::array<std::vector<double>, 2> rate;   ///< of way and heading, in deviations per s; a row each
    std::array<std::vector<double>, 2> error;  ///< of the change into a row, in deviations; NaN: none
    double squares = 0.0, count = 0.0;
};

double sawtooth(double turns) {
    return turns - std::floor(turns) - 0.5;
}

std::vector<double> differences(const std::vector<double>& values) {
    std::vector<double> changes(values.size(), 0.0);
    for (std::size_t i = 1; i < values.size(); ++i)
        changes[i] = values[i] - values[i - 1];
    return changes;
}

/// Per s, over the rows on either side.
std::vector<double> rates(const std::vector<double>& values, const std::vector<double>& time) {
    std::vector<double> slopes(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t from = i == 0 ? 0 : i - 1, to = std::min(i + 1, values.size() - 1);
        slopes[i] = (values[to] - values[from]) / std::max(time[to] - time[from], 1e-9);
    }
    return slopes;
}

Disagreement disagreement(const Run& run, const CountedPath& path) {
    Disagreement all;
    const std::size_t n = path.time.size();
    std::vector<double> mean(n), apart(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double time = run.counted_at.empty() ? path.time[i] : run.counted_at[path.row[i]];
        const double left = path.left_at(time).steps, right = path.right_at(time).steps;
        mean[i] = (left + right) / 2;
        apart[i] = right - left;
    }
    all.time = path.time;
    const auto ways = differences(mean), turns = differences(apart), spans = differences(path.time);
    for (std::size_t k = 0; k < 2; ++k) {
        const auto seen = differences(k == 0 ? path.way : path.heading);
        const auto turned = differences(path.heading);
        Eigen::MatrixXd terms(static_cast<Eigen::Index>(n), 3);
        for (std::size_t i = 0; i < n; ++i)
            terms.row(static_cast<Eigen::Index>(i)) = k == 0
                                                          ? Eigen::RowVector3d(ways[i], turned[i], 0.0)
                                                          : Eigen::RowVector3d(turns[i], ways[i], spans[i]);
        const Eigen::Map<const Eigen::VectorXd> target(seen.data(), static_cast<Eigen::Index>(n));
        const Eigen::Vector3d share = terms.completeOrthogonalDecomposition().solve(target);
        const Eigen::VectorXd rest = target - terms * share;
        std::vector<double> sizes;
        for (std::size_t i = 1; i < n; ++i)
            sizes.push_back(std::abs(rest[static_cast<Eigen::Index>(i)]));
        const double sd = robust_sd(std::move(sizes));
        all.rate[k] = rates(k == 0 ? mean : apart, path.time);
        for (double& rate : all.rate[k])
            rate *= share[0] / sd;
        all.error[k].assign(n, NAN);
        for (std::size_t i = 1; i < n; ++i) {
            const double error = rest[static_cast<Eigen::Index>(i)] / sd;
            if (std::abs(error) > kOutlier) continue;
            all.error[k][i] = error;
            all.squares += error * error;
            all.count += 1.0;
        }
    }
    return all;
}

/// Least squares of the errors on one shape of lateness.
struct Match {
    double gain = 0.0, size = 0.0;  ///< sum of squares that it takes away; s
};

Match match_sawtooth(const Disagreement& all, double beat, double phase) {
    thread_local std::vector<double> shape;
    shape.resize(all.time.size());
    for (std::size_t i = 0; i < shape.size(); ++i)
        shape[i] = sawtooth(beat * all.time[i] + phase);
    double product = 0.0, power = 1e-12;
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 1; i < shape.size(); ++i) {
            if (std::isnan(all.error[k][i])) continue;
            const double one = all.rate[k][i - 1] * shape[i - 1] - all.rate[k][i] * shape[i];
            product += one * all.error[k][i];
            power += one * one;
        }
    return {product * product / power, product / power};
}

struct Sinusoid {
    double gain = 0.0, cosine = 0.0, sine = 0.0, beat = 0.0;
};

Sinusoid match_sinusoid(const Disagreement& all, double beat) {
    Eigen::Matrix2d power = Eigen::Matrix2d::Identity() * 1e-12;
    Eigen::Vector2d product = Eigen::Vector2d::Zero();
    Eigen::Vector2d before = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < all.time.size(); ++i) {
        const double angle = 2 * std::numbers::pi * beat * all.time[i];
        const Eigen::Vector2d here(std::cos(angle), std::sin(angle));
        for (std::size_t k = 0; i > 0 && k < 2; ++k) {
            if (std::isnan(all.error[k][i])) continue;
            const Eigen::Vector2d one = all.rate[k][i - 1] * before - all.rate[k][i] * here;
            power += one * one.transpose();
            product += one * all.error[k][i];
        }
        before = here;
    }
    const Eigen::Vector2d size = power.ldlt().solve(product);
    return {product.dot(size), size[0], size[1], beat};
}

/// The best sawtooth near a sinusoid, which stands for its first harmonic. `turned`: it falls slowly.
FrameBeat polish(const Disagreement& all, const Sinusoid& first, double step, bool turned) {
    FrameBeat best;
    best.beat = first.beat;
    best.phase = std::atan2(turned ? first.cosine : -first.cosine, turned ? first.sine : -first.sine) /
                 (2 * std::numbers::pi);
    double finer = step, turn = 0.03;
    // A change of frequency turns the phase about the run's middle, not about time nought.
    const double middle = (all.time.front() + all.time.back()) / 2;
    for (int round = 0; round < kRounds; ++round, finer /= 2, turn /= 2) {
        const FrameBeat centre = best;
        for (int i = -kReach; i <= kReach; ++i)
            for (int j = -kReach; j <= kReach; ++j) {
                const double beat = centre.beat + i * finer,
                             phase = centre.phase + j * turn - i * finer * middle;
                const Match match = match_sawtooth(all, beat, phase);
                if (match.gain > best.gain) best = {match.size, beat, phase, match.gain};
            }
    }
    return best;
}

double deviance(const Disagreement& all, double gain) {
    return -all.count * std::log(std::max(1 - gain / all.squares, 1e-12));
}

FrameBeat beat_of(const Run& run, const CountedPath& path) {
    const Disagreement all = disagreement(run, path);
    const double span = path.span(), rows = static_cast<double>(path.time.size() - 1);
    const double step = 1 / (kFiner * span);
    Sinusoid first;
    for (double beat = kSlowest / span; beat < rows / span / 2; beat += step) {
        const Sinusoid one = match_sinusoid(all, beat);
        if (one.gain > first.gain) first = one;
    }
    if (first.gain <= 0.0) return {};
    const FrameBeat up = polish(all, first, step, false), down = polish(all, first, step, true);
    FrameBeat best = up.gain > down.gain ? up : down;
    const double sinusoid = deviance(all, first.gain);
    best.gain = deviance(all, best.gain);
    best.clear =
        best.gain > kEvidence && best.gain > sinusoid && std::abs(best.period) < kLongest * span / rows;
    return best;
}

}  // namespace

std::vector<FrameBeat> frame_beats(const Experiment& experiment) {
    if (experiment.kind != Kind::Motion) return {};
    std::vector<FrameBeat> beats;
    const auto paths = counted_paths(experiment);
    for (std::size_t r = 0; r < paths.size(); ++r)
        beats.push_back(beat_of(experiment.runs[r], paths[r]));
    return beats;
}

void align_frames(Experiment& experiment) {
    const auto beats = frame_beats(experiment);
    std::vector<double> periods;
    for (const FrameBeat& beat : beats)
        if (beat.clear) periods.push_back(std::abs(beat.period));
    if (periods.empty()) return;
    std::nth_element(periods.begin(), periods.begin() + static_cast<std::ptrdiff_t>(periods.size() / 2),
                     periods.end());
    const double period = periods[periods.size() / 2];
    const auto alike = [&](const FrameBeat& beat) {
        return std::abs(std::abs(beat.period) - period) < kAlike * period;
    };
    const auto clear = std::count_if(beats.begin(), beats.end(),
                                     [&](const FrameBeat& beat) { return beat.clear && alike(beat); });
    if (static_cast<double>(clear) < kLeastClear * static_cast<double>(beats.size())) return;
    for (std::size_t r = 0; r < beats.size(); ++r) {
        const FrameBeat& beat = beats[r];
        if (beat.gain < kEvidenceBesides || !alike(beat)) continue;
        Run& run = experiment.runs[r];
        const auto& time = run.column("t_s");
        if (run.counted_at.empty()) run.counted_at = time;
        for (std::size_t i = 0; i < time.size(); ++i)
            run.counted_at[i] -=
                std::copysign(period, beat.period) * sawtooth(beat.beat * time[i] + beat.phase);
    }
    experiment.cautions.push_back(fmt::format("the tracker tells poses at frames of its own, {:.3g} ms "
                                              "apart: a row is later than the one before until it "
                                              "falls back by a frame ({} of {} runs beyond doubt). Counters "
                                              "were read at the frames' times before anything "
                                              "was fitted",
                                              1e3 * period, clear, beats.size()));
}

}  // namespace puckloop::gap
