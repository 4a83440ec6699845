// A tracker that takes pictures at a rate of its own gives in each row the pose of its last picture: rows are
// late by a part of a frame that grows from row to row and falls back, a sawtooth. Errors of way are speed
// times lateness, not noise: few large ones one way, many small ones the other, which pull a fit that does
// not believe in large ones. Counters that are polled at a rate of their own make the same with the sign
// turned.

#include "gap/stats/robust.h"
#include "gap/sync/counted_path.h"
#include "gap/sync/sync.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kLeastTurns = 5.0;      // of the beat in a run: fewer are a clock's drift
constexpr double kFiner = 4.0;           // steps of frequency in one turn more over a run
constexpr std::size_t kSearched = 2500;  // rows: the beat is looked for in so many, then followed
constexpr double kUneven = 0.05;         // share of the time between rows
constexpr double kEvenRows = 0.95;       // share of rows that must be even
constexpr double kMostFramesMissing =
    4.0;  // times as long as the rows alone would last: no beat is kept over long gaps
constexpr double kOutlier = 6.0;           // sd: pushes and lost sight are left out
constexpr double kFrameEvidence = 60.0;    // deviance
constexpr double kEvidenceBesides = 30.0;  // of a run whose frames are as long as those of the clear ones
constexpr double kAlone = 4.0;       // times what stands out without it: rows late at random have many lines
constexpr double kLeastClear = 0.5;  // share of runs
constexpr double kAlike = 0.3;       // by how much frames of different runs may differ in length: noise
constexpr double kLongest = 0.9;     // of the time between rows: longer, and rows repeat frames
constexpr double kPhaseStep = 0.03;  // of a turn
constexpr int kSearchRounds = 5, kReach = 4;  // of the search for frequency and phase, and its width in steps

/// What tracker and counters disagree about from row to row, and what lateness would make of it: an error is
/// minus the change of rate times lateness.
struct Disagreement {
    /// Of way or heading.
    struct Sum {
        std::vector<double> rate;   ///< in deviations per s; a row each
        std::vector<double> error;  ///< of the change into a row, in deviations; NaN where it is left out
    };
    std::vector<double> time;  ///< s of the rows
    double step = 0.0;         ///< s between rows
    std::array<Sum, 2> sums;

    std::size_t rows() const { return time.size(); }
    double span() const { return time.back() - time.front(); }
};

/// A part of the rows.
struct Stretch {
    std::size_t from, to;
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

/// The time between rows, if they are evenly spaced but for missing ones: only then do beats beyond half the
/// rate of rows look like slower ones.
std::optional<double> even_step(const std::vector<double>& time) {
    const std::vector<double> spaces = stats::steps_of(time);
    const double step = stats::median(spaces);
    if (!(step > 0)) return std::nullopt;
    const auto even = std::count_if(spaces.begin(), spaces.end(), [&](double space) {
        const double steps = space / step;
        return steps > 0.5 && std::abs(steps - std::round(steps)) < kUneven;
    });
    const auto count = static_cast<double>(spaces.size());
    if (static_cast<double>(even) < kEvenRows * count) return std::nullopt;
    if (time.back() - time.front() > kMostFramesMissing * count * step) return std::nullopt;
    return step;
}

/// What is left of `seen` when it is explained by the three columns of `terms` as well as they can, and the
/// share of the first.
Disagreement::Sum unexplained(const std::vector<double>& seen, const Eigen::MatrixX3d& terms,
                              std::vector<double> rate) {
    const Eigen::Map<const Eigen::VectorXd> target(seen.data(), static_cast<Eigen::Index>(seen.size()));
    const Eigen::Vector3d share = terms.completeOrthogonalDecomposition().solve(target);
    const Eigen::VectorXd rest = target - terms * share;
    const double sd = robust_sd({rest.begin() + 1, rest.end()});
    Disagreement::Sum sum;
    sum.rate = std::move(rate);
    for (double& one : sum.rate)
        one *= share[0] / sd;
    sum.error.assign(seen.size(), NAN);
    for (std::size_t i = 1; i < seen.size(); ++i) {
        const double error = rest[static_cast<Eigen::Index>(i)] / sd;
        if (std::abs(error) <= kOutlier) sum.error[i] = error;
    }
    return sum;
}

Disagreement disagreement(const CountedPath& path, double step) {
    const std::size_t n = path.time.size();
    std::vector<double> mean(n), apart(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double left = path.left_at(path.when[i]).steps, right = path.right_at(path.when[i]).steps;
        mean[i] = (left + right) / 2;
        apart[i] = right - left;
    }
    const auto ways = differences(mean), turns = differences(apart), spans = differences(path.time),
               turned = differences(path.heading);
    Eigen::MatrixX3d of_way(static_cast<Eigen::Index>(n), 3), of_heading(static_cast<Eigen::Index>(n), 3);
    for (std::size_t i = 0; i < n; ++i) {
        of_way.row(static_cast<Eigen::Index>(i)) << ways[i], turned[i], 0.0;
        of_heading.row(static_cast<Eigen::Index>(i)) << turns[i], ways[i], spans[i];
    }
    Disagreement all;
    all.time = path.time;
    all.step = step;
    all.sums = {unexplained(differences(path.way), of_way, rates(mean, path.time)),
                unexplained(turned, of_heading, rates(apart, path.time))};
    return all;
}

/// What a row's error would be if the row before were late by `before` and it by `here`.
template <class Number>
Number effect_of(const Disagreement::Sum& sum, std::size_t row, const Number& before, const Number& here) {
    return sum.rate[row - 1] * before - sum.rate[row] * here;
}

struct Sawtooth {
    double beat = 0.0, phase = 0.0;  ///< Hz; of a turn
    double gain = 0.0, size = 0.0;   ///< sum of squares that it takes away; s
};

/// Least squares of the errors on a sawtooth.
Sawtooth matched(const Disagreement& all, const Stretch& part, double beat, double phase) {
    double product = 0.0, power = 1e-12;
    for (const Disagreement::Sum& sum : all.sums) {
        double before = sawtooth(beat * all.time[part.from] + phase);
        for (std::size_t i = part.from + 1; i < part.to; ++i) {
            const double here = sawtooth(beat * all.time[i] + phase);
            const double one = effect_of(sum, i, before, here);
            before = here;
            if (std::isnan(sum.error[i])) continue;
            product += one * sum.error[i];
            power += one * one;
        }
    }
    return {beat, phase, product * product / power, product / power};
}

struct Sinusoid {
    double gain = 0.0, cosine = 0.0, sine = 0.0, beat = 0.0;
};

/// Least squares of the errors on sinusoids of all frequencies, the best of them. `step`: in Hz.
Sinusoid best_sinusoid(const Disagreement& all, const Stretch& part, double step) {
    const std::size_t n = part.to - part.from;
    const double lowest = kLeastTurns / (all.time[part.to - 1] - all.time[part.from]);
    // Each row's angle goes on by the same from frequency to frequency.
    std::vector<std::complex<double>> angle(n), turn(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double time = all.time[part.from + i];
        angle[i] = std::polar(1.0, 2 * std::numbers::pi * lowest * time);
        turn[i] = std::polar(1.0, 2 * std::numbers::pi * step * time);
    }
    Sinusoid best;
    for (double beat = lowest; beat < 0.5 / all.step; beat += step) {
        Eigen::Matrix2d power = Eigen::Matrix2d::Identity() * 1e-12;
        Eigen::Vector2d product = Eigen::Vector2d::Zero();
        for (const Disagreement::Sum& sum : all.sums)
            for (std::size_t i = 1; i < n; ++i) {
                const std::size_t row = part.from + i;
                if (std::isnan(sum.error[row])) continue;
                const std::complex<double> one = effect_of(sum, row, angle[i - 1], angle[i]);
                power(0, 0) += one.real() * one.real();
                power(0, 1) += one.real() * one.imag();
                power(1, 1) += one.imag() * one.imag();
                product[0] += one.real() * sum.error[row];
                product[1] += one.imag() * sum.error[row];
            }
        power(1, 0) = power(0, 1);
        const Eigen::Vector2d size = power.ldlt().solve(product);
        if (const double gain = product.dot(size); gain > best.gain) best = {gain, size[0], size[1], beat};
        for (std::size_t i = 0; i < n; ++i)
            angle[i] *= turn[i];
    }
    return best;
}

/// The best sawtooth around one. A change of frequency turns the phase about the middle, not about time
/// nought.
Sawtooth polished(const Disagreement& all, const Stretch& part, Sawtooth best, double step) {
    const double middle = (all.time[part.from] + all.time[part.to - 1]) / 2;
    double turn = kPhaseStep;
    best = matched(all, part, best.beat, best.phase);
    for (int round = 0; round < kSearchRounds; ++round, step /= 2, turn /= 2) {
        const Sawtooth centre = best;
        for (int i = -kReach; i <= kReach; ++i)
            for (int j = -kReach; j <= kReach; ++j) {
                const Sawtooth one =
                    matched(all, part, centre.beat + i * step, centre.phase + j * turn - i * step * middle);
                if (one.gain > best.gain) best = one;
            }
    }
    return best;
}

/// The rows around the middle.
Stretch middle_rows(std::size_t rows, std::size_t wanted) {
    const std::size_t count = std::min(rows, wanted), from = (rows - count) / 2;
    return {from, from + count};
}

/// The sawtooth that a sinusoid in the middle rows is the first harmonic of, followed to all rows.
/// `falls`: it falls slowly and jumps up.
Sawtooth followed(const Disagreement& all, const Sinusoid& first, double step, bool falls) {
    const double sign = falls ? 1.0 : -1.0;
    Sawtooth best{first.beat, std::atan2(sign * first.cosine, sign * first.sine) / (2 * std::numbers::pi)};
    for (std::size_t rows = kSearched;; rows *= 2, step /= 2) {
        const Stretch part = middle_rows(all.rows(), rows);
        best = polished(all, part, best, step);
        if (part.to - part.from == all.rows()) return best;
    }
}

/// By how much the deviance of the rows of `part` falls when `gain` is taken off the sum of their squares.
double deviance(const Disagreement& all, const Stretch& part, double gain) {
    double squares = 0.0, count = 0.0;
    for (const Disagreement::Sum& sum : all.sums)
        for (std::size_t i = part.from + 1; i < part.to; ++i)
            if (!std::isnan(sum.error[i])) {
                squares += sum.error[i] * sum.error[i];
                count += 1.0;
            }
    return squares > 0 ? -count * std::log(std::max(1 - gain / squares, 1e-12)) : 0.0;
}

FrameBeat beat_of(const CountedPath& path) {
    const auto step = even_step(path.time);
    if (!step) return {};
    Disagreement all = disagreement(path, *step);
    const Stretch searched = middle_rows(all.rows(), kSearched), whole{0, all.rows()};
    const double finer = 1 / (kFiner * (all.time[searched.to - 1] - all.time[searched.from]));
    const Sinusoid first = best_sinusoid(all, searched, finer);
    if (!(first.gain > 0)) return {};
    const Sawtooth up = followed(all, first, finer, false), down = followed(all, first, finer, true);
    const Sawtooth& best = up.gain > down.gain ? up : down;
    FrameBeat beat{best.size, best.beat, best.phase, deviance(all, whole, best.gain), false};
    if (beat.evidence < kEvidenceBesides) return beat;
    const double there = deviance(all, searched, matched(all, searched, best.beat, best.phase).gain);
    if (there <= deviance(all, searched, first.gain)) return beat;
    const auto late = [&](std::size_t row) {
        return best.size * sawtooth(best.beat * all.time[row] + best.phase);
    };
    for (Disagreement::Sum& sum : all.sums)
        for (std::size_t i = 1; i < all.rows(); ++i)
            sum.error[i] -= effect_of(sum, i, late(i - 1), late(i));
    const double next = deviance(all, searched, best_sinusoid(all, searched, finer).gain);
    beat.clear =
        beat.evidence > kFrameEvidence && there > kAlone * next && std::abs(beat.period) < kLongest * *step;
    return beat;
}

/// Has each run its counters read at its frames' times where frames are beyond doubt. False: they are not.
bool align_frames(Experiment& experiment, const std::vector<FrameBeat>& beats) {
    std::vector<double> periods;
    for (const FrameBeat& beat : beats)
        if (beat.clear) periods.push_back(std::abs(beat.period));
    if (periods.empty()) return false;
    const double period = stats::median(periods);
    const auto alike = [&](const FrameBeat& beat) {
        return std::abs(std::abs(beat.period) - period) < kAlike * period;
    };
    const auto clear = std::count_if(beats.begin(), beats.end(),
                                     [&](const FrameBeat& beat) { return beat.clear && alike(beat); });
    if (static_cast<double>(clear) < kLeastClear * static_cast<double>(beats.size())) return false;
    for (std::size_t r = 0; r < beats.size(); ++r) {
        const FrameBeat& beat = beats[r];
        Run& run = experiment.runs[r];
        run.counted_at = run.column("t_s");
        if (!(beat.evidence >= kEvidenceBesides && alike(beat))) continue;
        for (double& time : run.counted_at)
            time -= std::copysign(period, beat.period) * sawtooth(beat.beat * time + beat.phase);
    }
    experiment.caution(
        "the tracker gives poses at frames of its own, about {:.2g} ms apart (or the counters "
        "are polled so): a row is later than the one before until it falls back by a frame ({} "
        "of {} runs beyond doubt). Counters were read at the frames' times before anything was "
        "fitted; half a frame of a tracker's delay is theirs",
        1e3 * period, clear, beats.size());
    return true;
}

}  // namespace

std::vector<FrameBeat> frame_beats(const Experiment& experiment) {
    if (experiment.kind != Kind::Motion) return {};
    std::vector<FrameBeat> beats;
    for (const CountedPath& path : counted_paths(experiment))
        beats.push_back(beat_of(path));
    return beats;
}

void align_times(Experiment& experiment) {
    Experiment aligned = experiment;
    align_clocks(aligned);
    // In short runs frames pass for drift: without them the clocks are looked at anew.
    if (align_frames(experiment, frame_beats(aligned)))
        align_clocks(experiment);
    else
        experiment = std::move(aligned);
}

}  // namespace puckloop::gap
