#include "gap/models/batches.h"

#include "gap/stats/robust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
constexpr double kBatchEdge = 0.02;      // of a batch: rounding of clocks
constexpr double kClockDoubt = 3e-4;     // s: when in its loop the robot reads its clock
constexpr std::size_t kShareEarly = 30;  // one frame in so many is taken to have waited least
constexpr double kClockSd = 1e-4;        // s: of that doubt
constexpr double kMostLater = 8.0;       // batches: what comes later still is late by itself
constexpr std::size_t kParts = 8;        // of a batch: where frames that wait before it miss it alike
constexpr double kFrameRoundings = 2.0;  // of the robot's clock: how much less even frames may look
constexpr double kFineBatch = 10.0;      // clock doubts: in a shorter batch the arrival has no say
constexpr double kLongestFine = 0.02;    // s: longer ones show in the arrivals themselves
constexpr std::size_t kStretch = 20;     // rows
constexpr std::size_t kCoherent = 500;   // rows that are added up in phase, before whole runs are
constexpr double kSteps = 3.0;           // of frequency, for each that a stretch parts
constexpr double kBand = 5.0;            // Hz: half of what frames at even times part
constexpr std::size_t kBandsTried = 24;
constexpr double kHalfMet = 2 / std::numbers::pi;  // length of the mean of phases spread over half a turn
constexpr double kSurelyMet = 9.2;  // of phases: as far from even ones as by chance once in 10 000 (Rayleigh)
constexpr double kClearBeat = 6.0;  // deviations: the best of some thousand frequencies is some 4
constexpr std::size_t kBatchesTried = 6;  // of the bands' batches, by what they leave

/// A phase that goes on by even steps.
struct Turning {
    std::complex<double> now, by;
    void turn() {  // std::complex's own product also sees to infinities
        now = {now.real() * by.real() - now.imag() * by.imag(),
               now.real() * by.imag() + now.imag() * by.real()};
    }
};

double nearest(double time, double batch, double phase) {
    return phase + batch * std::round((time - phase) / batch);
}

/// When a frame is ready, counted in batches from one that leaves at 0.
double in_batches(const BatchGrid& grid, double ready) {
    return (ready + grid.least - grid.phase) / grid.batch;
}

/// Delivered at whole multiples of the batch: each frame waits for the next one. The arrival itself shows
/// whether it caught that one, the one before or a later one. Returns the sum of the distances from batches
/// that the time it was ready at allows.
double deliver(const Observable& o, std::size_t from, std::size_t to, const BatchGrid& grid,
               const std::vector<double>& ready, Placed& placed) {
    const double doubt = std::max(kBatchEdge, kClockDoubt / grid.batch);
    double off = 0.0;
    for (std::size_t k = from; k < to; ++k) {
        const double now = in_batches(grid, ready[k]), next = std::ceil(now),
                     caught = std::round((o.y[k] - grid.phase) / grid.batch);
        placed.later[k] = std::clamp(caught - next, -1.0, kMostLater);
        placed.before[k] = next - now;
        placed.mean[k] = grid.phase + grid.batch * (next + placed.later[k]);
        const double allowed = std::clamp(caught, std::ceil(now - doubt), std::ceil(now + doubt));
        off += std::abs(o.y[k] - grid.phase - grid.batch * allowed);
    }
    return off;
}

/// Batches so short that the arrival would show it of most frames whether they caught one: the mean of both
/// that may be is expected, and how far they lie apart. Returns the sum of the distances.
double deliver_fine(const Observable& o, std::size_t from, std::size_t to, const BatchGrid& grid,
                    const std::vector<double>& ready, Placed& placed) {
    double off = 0.0;
    for (std::size_t k = from; k < to; ++k) {
        const double now = in_batches(grid, ready[k]), next = std::ceil(now), since = now - (next - 1);
        const double edge = std::min(since, 1 - since) * grid.batch;
        const double other = 0.5 * std::erfc(edge / (kClockSd * std::numbers::sqrt2));
        placed.mean[k] = grid.phase + grid.batch * (since < 0.5 ? next - other : next + other);
        placed.extra[k] = grid.batch * std::sqrt(other * (1 - other));
        off += std::abs(o.y[k] - placed.mean[k]);
    }
    return off;
}

/// Each half of a run is placed by the other: a saw fine enough follows any slow error of the rows that
/// it was placed by, and only a batch goes on so in rows that had no part in it.
double place_by_waits(const Observable& o, std::size_t from, std::size_t to, double batch,
                      const std::vector<double>& arrival, Placed& placed) {
    const std::size_t half = from + (to - from) / 2;
    const auto jump_in = [&](std::size_t first, std::size_t last) {
        double usual = 0.0;
        for (std::size_t k = first; k < last; ++k)
            usual += (o.y[k] - arrival[k]) / static_cast<double>(last - first);
        std::complex<double> saw;
        for (std::size_t k = first; k < last; ++k)
            saw += (o.y[k] - arrival[k] - usual) * std::polar(1.0, kFullTurn * arrival[k] / batch);
        // Waits fall by one for each one later that a frame is ready, and jump where a batch leaves.
        return (std::arg(saw) - std::numbers::pi / 2) / kFullTurn * batch;
    };
    const double early_jump = jump_in(half, to), late_jump = jump_in(from, half);
    std::vector<double> rest;
    for (std::size_t k = from; k < to; ++k) {
        const double before = (k < half ? early_jump : late_jump) - arrival[k];
        rest.push_back(o.y[k] - arrival[k] - (before - batch * std::floor(before / batch)));
    }
    const double middle = stats::upper_median(std::move(rest));
    return deliver_fine(o, from, half, {batch, early_jump + middle, middle, middle}, arrival, placed) +
           deliver_fine(o, half, to, {batch, late_jump + middle, middle, middle}, arrival, placed);
}

/// The batch near by that the waits of stretches of `rows` beat with most, looked for in steps by which their
/// longest turns by one of `parts` of a turn. `reach` and `step` are shares of the batch.
double best_near(const Observable& o, std::size_t rows, const std::vector<double>& ready,
                 const std::vector<double>& waited, double batch, double reach, double parts, double& step) {
    const auto stretches = stretches_of(o, rows);
    double longest = 0.0;
    for (const auto& [from, to] : stretches)
        longest = std::max(longest, ready[to - 1] - ready[from]);
    step = std::min(batch / (parts * std::max(longest, batch)), reach);
    double most = 0.0, best = batch;
    for (double off = -reach; off <= reach; off += step) {
        double power = 0.0;
        for (const auto& [from, to] : stretches) {
            std::complex<double> sum;
            for (std::size_t i = from; i < to; ++i)
                sum += waited[i] * std::polar(1.0, kFullTurn * ready[i] / (batch * (1 + off)));
            power += std::norm(sum);
        }
        if (power <= most) continue;
        most = power;
        best = batch * (1 + off);
    }
    return best;
}

/// In stretches first, which fewer steps are enough for, then in whole runs.
double refined_by_waits(const Observable& o, const std::vector<double>& ready,
                        const std::vector<double>& waited, double batch, double reach) {
    double step = 0.0;
    batch = best_near(o, kCoherent, ready, waited, batch, reach, 4, step);
    batch = best_near(o, o.y.size(), ready, waited, batch, 1.5 * step, 4, step);
    return best_near(o, o.y.size(), ready, waited, batch, step, 40, step);
}

}  // namespace

std::vector<std::pair<std::size_t, std::size_t>> stretches_of(const Observable& o, std::size_t longest) {
    std::vector<std::pair<std::size_t, std::size_t>> all;
    for (std::size_t from = 0, to = 0; from < o.y.size(); from = to) {
        do
            ++to;
        while (to < o.y.size() && to - from < longest && o.starts[to] == 0);
        all.emplace_back(from, to);
    }
    return all;
}

bool is_fine_batch(double batch) {
    return batch < kFineBatch * kClockDoubt;
}

double BatchGrid::wait(double ready) const {
    const double slots = (ready + first - phase) / batch;
    return (std::ceil(slots) - slots) * batch;
}

BatchGrid grid_of(const Observable& o, std::size_t from, std::size_t to, double batch,
                  const std::vector<double>& ready) {
    std::complex<double> beat;
    for (std::size_t k = from; k < to; ++k)
        beat += std::polar(1.0, kFullTurn * o.y[k] / batch);
    const double phase = std::arg(beat) / kFullTurn * batch;
    std::vector<double> waits;
    for (std::size_t k = from; k < to; ++k)
        waits.push_back(nearest(o.y[k], batch, phase) - ready[k]);
    const auto early = waits.begin() + static_cast<std::ptrdiff_t>(waits.size() / kShareEarly);
    std::nth_element(waits.begin(), early, waits.end());
    // Waits are even: so much less than one seen is possible.
    return {batch, phase, *early - batch / static_cast<double>(kShareEarly),
            *std::min_element(waits.begin(), early + 1) - batch / static_cast<double>(2 * (to - from))};
}

double place_batches(const Observable& o, std::size_t from, std::size_t to, double batch,
                     const std::vector<double>& arrival, Placed& placed) {
    const bool fine = is_fine_batch(batch);
    placed.mean.resize(o.y.size());
    for (auto* rows : fine ? std::vector{&placed.extra} : std::vector{&placed.later, &placed.before})
        rows->resize(o.y.size());
    if (fine) return place_by_waits(o, from, to, batch, arrival, placed);
    return deliver(o, from, to, grid_of(o, from, to, batch, arrival), arrival, placed);
}

void pass_over_locked(std::size_t from, std::size_t to, double batch, const std::vector<double>& begun,
                      const std::vector<double>& ready, Placed& placed) {
    std::complex<double> beat;
    for (std::size_t k = from; k < to; ++k)
        beat += std::polar(1.0, kFullTurn * begun[k] / batch);
    const auto rows = static_cast<double>(to - from);
    if (std::abs(beat) < kHalfMet * rows || std::norm(beat) < kSurelyMet * rows) return;
    for (std::size_t k = from; k < to; ++k) {
        placed.mean[k] = ready[k];
        placed.extra[k] = 0.0;
    }
}

void follow_even_frames(std::size_t from, std::size_t to, double batch, double rounding,
                        const std::vector<double>& ready, Placed& placed) {
    if (is_fine_batch(batch)) return;
    const auto wait = [&](std::size_t k) { return placed.mean[k] - batch * placed.later[k] - ready[k]; };
    for (std::size_t k = from + 1; k < to; ++k)
        if (std::abs(wait(k) - wait(k - 1)) > kClockDoubt + kFrameRoundings * rounding) return;
    for (std::size_t k = from; k < to; ++k)
        placed.mean[k] = ready[k] + batch * placed.later[k];
}

std::vector<double> chances_of(const Placed& placed) {
    const auto part = [&](std::size_t k) {
        return static_cast<std::size_t>(kParts * placed.before[k]) % kParts;
    };
    std::array<double, kParts> rows{}, caught{};
    for (std::size_t k = 0; k < placed.later.size(); ++k) {
        rows[part(k)] += 1;
        caught[part(k)] += placed.later[k] == 0.0 ? 1 : 0;
    }
    std::vector<double> chance;
    for (std::size_t k = 0; k < placed.later.size(); ++k) {
        const double next = (caught[part(k)] + 0.5) / (rows[part(k)] + 1);
        chance.push_back(placed.later[k] == 0.0 ? next : (1 - next) / (1 + kMostLater));
    }
    return chance;
}

std::vector<double> beats_of_waits(const Observable& o, const std::vector<double>& ready, double shortest,
                                   double between) {
    const std::size_t n = o.y.size();
    const double highest = 1 / shortest, lowest = 1 / kLongestFine;
    if (n < 2 * kStretch || !(highest > lowest)) return {};
    std::vector<double> waited;
    std::vector<std::size_t> ends;
    for (const auto& [i, end] : stretches_of(o, kStretch)) {
        ends.push_back(end);
        double mean = 0.0, squares = 0.0;
        for (std::size_t k = i; k < end; ++k)
            mean += (o.y[k] - ready[k]) / static_cast<double>(end - i);
        for (std::size_t k = i; k < end; ++k)
            squares += std::pow(o.y[k] - ready[k] - mean, 2);
        for (std::size_t k = i; k < end; ++k)
            waited.push_back(squares > 0 ? (o.y[k] - ready[k] - mean) / std::sqrt(squares) : 0.0);
    }
    // Each stretch's power is about exponential, of mean one, where nothing beats.
    const double usual = static_cast<double>(ends.size());
    const double step = 1 / (kSteps * kStretch * between);
    std::vector<Turning> turning;
    for (const double at : ready)
        turning.push_back({std::polar(1.0, kFullTurn * lowest * at), std::polar(1.0, kFullTurn * step * at)});
    // Frames come at nearly even times, which many frequencies beat with alike: the best of each band is
    // looked at as a batch.
    const double clear = usual + kClearBeat * std::sqrt(usual);
    std::vector<std::pair<double, double>> bands;  // power, batch
    double beyond = 0.0;
    for (double frequency = lowest; frequency < highest; frequency += step) {
        double power = 0.0;
        std::size_t i = 0;
        for (const std::size_t end : ends) {
            double re = 0.0, im = 0.0;
            for (; i < end; ++i) {
                re += waited[i] * turning[i].now.real();
                im += waited[i] * turning[i].now.imag();
                turning[i].turn();
            }
            power += re * re + im * im;
        }
        if (power <= clear) continue;
        if (bands.empty() || frequency > beyond) {
            bands.emplace_back(power, 1 / frequency);
            beyond = frequency + kBand;
        } else if (power > bands.back().first) {
            bands.back() = {power, 1 / frequency};
        }
    }
    std::sort(bands.rbegin(), bands.rend());
    bands.resize(std::min(bands.size(), kBandsTried));
    Placed placed;
    std::vector<std::pair<double, double>> tried;  // what is left, batch
    const auto look_at = [&](double coarse) {
        const double batch = refined_by_waits(o, ready, waited, coarse, 2 * step * coarse);
        double off = 0.0;
        for (const auto& [from, to] : stretches_of(o, n))
            off += place_batches(o, from, to, batch, ready, placed);
        tried.emplace_back(off, batch);
    };
    for (const auto& [power, coarse] : bands)
        look_at(coarse);
    // What leaves least is looked for on both sides of the best, a beat with the frames' own rate at a time.
    for (std::size_t looked = 0; !tried.empty() && looked < kBandsTried; ++looked) {
        std::sort(tried.begin(), tried.end());
        const double best = tried[0].second;
        for (const double side : {-1.0, 1.0}) {
            const double beside = 1 / (1 / best + side / between);
            const bool known = std::any_of(tried.begin(), tried.end(), [&](const auto& one) {
                return std::abs(1 / one.second - 1 / beside) < 2 * step;
            });
            if (!known && beside > shortest) look_at(beside);
        }
        if (std::min_element(tried.begin(), tried.end())->second == best) break;
    }
    std::sort(tried.begin(), tried.end());
    std::vector<double> found;
    for (std::size_t k = 0; k < std::min(kBatchesTried, tried.size()); ++k)
        found.push_back(tried[k].second);
    return found;
}

}  // namespace puckloop::gap
