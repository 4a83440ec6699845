#include "gap/validate/checks.h"

#include "gap/kinds/columns.h"
#include "gap/stats/noise_floor.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace puckloop::gap {

namespace {

bool separated_by_unit(const Run& run) {
    const auto& units = run.column("unit");
    return std::any_of(units.begin(), units.end(), [&](double unit) { return unit != units.front(); });
}

// ---- motion

/// m/s that no robot here exceeds: by its commands, else by what is built.
double fastest(const Experiment& experiment, const Run& run) {
    constexpr double kAny = 1.0, kOver = 1.5;
    if (!run.has("cmd_left") || !run.has("cmd_right")) return kAny;
    double steps = 0.0;
    for (const char* name : {"cmd_left", "cmd_right"})
        for (const double value : run.column(name))
            if (!std::isnan(value)) steps = std::max(steps, std::abs(value));
    return kOver * steps * metres_per_step(experiment);
}

/// Each row belongs to that of two paths whose end is nearer; the second begins with the first jump that no
/// robot makes. One robot seen badly jumps anywhere, two robots each go on where they were.
void check_paths(const Experiment& experiment, const Run& run) {
    constexpr double kTracker = 0.03;    // m: jumps of a tracker's noise
    constexpr double kOwn = 0.3;         // of a jump: as near is the end of the own path
    constexpr std::size_t kFewest = 6;   // changes between the paths
    constexpr double kLeastShare = 0.1;  // of the rows on either path
    struct End {
        double x, y;
    };
    const auto &x = run.column("x_m"), &y = run.column("y_m"), &time = run.column("t_s");
    const double speed = fastest(experiment, run);
    End ends[2] = {};
    std::size_t count[2] = {0, 0}, first = 0;
    int on = 0;
    std::vector<double> shares;
    double far = 0.0, before = 0.0;
    for (std::size_t i = 0; i < run.rows; ++i) {
        if (std::isnan(x[i] + y[i] + time[i])) continue;
        const auto to = [&](int path) { return std::hypot(x[i] - ends[path].x, y[i] - ends[path].y); };
        if (count[0] > 0) {
            const double jump = to(on), reach = kTracker + speed * (time[i] - before);
            const bool change = jump > reach && (count[1] == 0 || to(1 - on) < jump);
            if (change) {
                if (count[1] > 0) shares.push_back(to(1 - on) / jump);
                if (count[1] == 0) first = i;
                far = std::max(far, jump);
                on = 1 - on;
            }
        }
        ends[on] = {x[i], y[i]};
        ++count[on];
        before = time[i];
    }
    const auto least = kLeastShare * static_cast<double>(count[0] + count[1]);
    if (shares.size() < kFewest || static_cast<double>(std::min(count[0], count[1])) < least) return;
    if (stats::upper_median(shares) > kOwn) return;
    refuse(experiment, run,
           fmt::format("the pose jumps to and fro between two paths, {} times and up to {:.2g} m: rows of "
                       "two robots are mixed, or the tracker took another one for it",
                       shares.size() + 1, far),
           "one robot a file", static_cast<long>(first));
}

// ---- timing

/// A number that lies beyond both its neighbours', which count on without it, is a damaged one: by far, for a
/// frame given twice is none. Where many do, something else is wrong.
void drop_damaged_numbers(Experiment& experiment, Run& run, std::vector<double>& seq) {
    constexpr double kBeyond = 2.0, kFewDamaged = 0.02;  // numbers; share of the rows
    std::vector<std::size_t> damaged;
    for (std::size_t i = 1; i + 1 < seq.size(); ++i) {
        const double before = seq[i - 1], after = seq[i + 1];
        if (before < after && (seq[i] > after + kBeyond || seq[i] < before - kBeyond)) damaged.push_back(i);
    }
    if (static_cast<double>(damaged.size()) > std::max(1.0, kFewDamaged * static_cast<double>(seq.size())))
        return;
    for (const std::size_t i : damaged) {
        experiment.caution("{}: seq = {:.6g} in row {} lies beyond both its neighbours: taken as missing",
                           run.file, seq[i], i + 1);
        seq[i] = std::nan("");
    }
}

/// Puts numbers of a counter of 8 or 16 bits together over its wraps.
void put_together(Experiment& experiment, Run& run, std::vector<double>& seq) {
    constexpr double kNear = 8.0;  // frames that may be missing at the wrap
    double added = 0.0, wrap = 0.0;
    for (std::size_t i = 1; i < seq.size(); ++i) {
        seq[i] += added;
        const double short_of = seq[i - 1] + 1 - seq[i], own = seq[i] - added;
        for (const double numbers : {256.0, 65536.0}) {
            if (!(own < kNear && short_of <= numbers && short_of > numbers - kNear)) continue;
            seq[i] += numbers;
            added += wrap = numbers;
        }
    }
    if (wrap > 0)
        experiment.caution("{}: seq is a counter that wraps at {:g}: put together over wraps", run.file,
                           wrap);
}

/// Frames that were lost are seen by their rows only: what is not there looks like nothing wrong.
void report_absent(Experiment& experiment, const Run& run, const std::vector<double>& seq) {
    constexpr double kFewAbsent = 0.02;  // rows go missing for other reasons as well
    double absent = 0.0;
    std::size_t first = 0;
    for (std::size_t i = 1; i < seq.size(); ++i) {
        const double between = seq[i] - seq[i - 1] - 1;
        if (!(between > 0)) continue;
        if (absent == 0.0) first = i;
        absent += between;
    }
    if (absent <= kFewAbsent * (absent + static_cast<double>(seq.size()))) return;
    experiment.caution(
        "{}: {:.0f} frame numbers have no row (seq goes from {:.0f} to {:.0f} at row {}): a frame that was "
        "lost needs a row with frame_ok = 0, else nothing can be found about losses",
        run.file, absent, seq[first - 1], seq[first], first + 1);
}

void check_frames(Experiment& experiment, Run& run) {
    constexpr double kMostBack = 0.05;
    constexpr std::size_t kFew = 3, kEnough = 20;
    if (const auto numbers = run.columns.find("seq"); numbers != run.columns.end()) {
        put_together(experiment, run, numbers->second);
        drop_damaged_numbers(experiment, run, numbers->second);
    }
    const auto& seq = run.column("seq");
    std::size_t back = 0, first = 0;
    for (std::size_t i = 1; i < seq.size(); ++i)
        if (seq[i] <= seq[i - 1] && back++ == 0) first = i;
    if (back > kFew && static_cast<double>(back) > kMostBack * static_cast<double>(seq.size()))
        refuse(experiment, run,
               fmt::format("seq does not count on ({:g} after {:g}; so in {} of {} rows): frames of two "
                           "robots are mixed, or given twice",
                           seq[first], seq[first - 1], back, seq.size()),
               "one robot a file, each frame once", static_cast<long>(first));
    report_absent(experiment, run, seq);
    const auto host = stats::finite(run.column("t_host_s"));
    const auto& period = run.column("nominal_period");
    if (!seq.empty() || period.empty() || std::isnan(period.front())) return;
    if (host.size() < kEnough) return;
    const double ratio = (host.back() - host.front()) / static_cast<double>(host.size() - 1) / period.front();
    if (ratio > 0.4 && ratio < 0.6)
        experiment.caution("{}: frames come every {:.3g} s where nominal_period is "
                           "{:.3g} s: another period, or frames of two robots mixed?",
                           run.file, ratio * period.front(), period.front());
}

// ---- readings at placements

/// Rows by placement, which everything holds that is given of a row but when it was and what else was read; a
/// jig's noise counts for nothing.
std::map<int, std::vector<std::size_t>> placements(const Experiment& experiment, const Run& run) {
    constexpr double kJig = 1e-3;  // of a column's range
    static const std::set<std::string_view> passing{
        "t_s", "order", "temperature_c", "battery_v", "pair_reading", "neighbour_reading", "ambient_reading"};
    std::vector<std::vector<double>> given;
    for (const ColumnInfo& info : columns_of(experiment.kind))
        if (run.has(info.name) && info.role != Role::Observable && !passing.contains(info.name))
            given.push_back(run.column(info.name));
    const std::vector<int> number = stats::stimulus_numbers(given, kJig);
    std::map<int, std::vector<std::size_t>> rows;
    for (std::size_t i = 0; i < number.size(); ++i)
        if (number[i] >= 0) rows[number[i]].push_back(i);
    return rows;
}

struct Levels {
    bool two = false;
    double low = 0.0, high = 0.0;
};

/// Two clusters with nothing between them, between which the rows go to and fro.
Levels levels_of(const std::vector<double>& readings, double quantum) {
    constexpr double kApart = 8.0;    // mean deviations inside the clusters
    constexpr double kRobots = 0.03;  // of the level: robots differ by more, converters hop by less
    constexpr double kEmpty = 0.6;    // of the way between the medians
    constexpr double kLeast = 0.2;    // share of the smaller cluster
    constexpr int kChanges = 3;       // a single one may be something that moved
    std::vector<double> sorted = readings;
    std::sort(sorted.begin(), sorted.end());
    const std::size_t n = sorted.size(),
                      least =
                          std::max<std::size_t>(3, static_cast<std::size_t>(kLeast * static_cast<double>(n)));
    std::size_t cut = least;
    for (std::size_t k = least; k + least <= n; ++k)
        if (sorted[k] - sorted[k - 1] > sorted[cut] - sorted[cut - 1]) cut = k;
    const auto part = [&](std::size_t from, std::size_t to) {
        const double middle = sorted[(from + to) / 2];
        double deviation = 0.0;
        for (std::size_t k = from; k < to; ++k)
            deviation += std::abs(sorted[k] - middle) / static_cast<double>(to - from);
        return std::pair{middle, deviation};
    };
    const auto [low, low_scatter] = part(0, cut);
    const auto [high, high_scatter] = part(cut, n);
    const double gap = sorted[cut] - sorted[cut - 1], apart = high - low;
    if (apart < kRobots * std::abs(high)) return {};
    if (apart < kApart * std::max({low_scatter, high_scatter, quantum}) || gap < kEmpty * apart) return {};
    int changes = 0;
    for (std::size_t k = 1; k < n; ++k)
        changes += (readings[k] >= sorted[cut]) != (readings[k - 1] >= sorted[cut]) ? 1 : 0;
    return {changes >= kChanges, low, high};
}

void check_levels(Experiment& experiment, const Run& run, const char* observable) {
    constexpr std::size_t kRepeats = 8, kPlacements = 3;
    constexpr double kLeastSplit = 0.25;  // far placements and dark floors show no difference
    const auto& readings = run.column(observable);
    const auto instrument = experiment.instruments.find(observable);
    const double quantum =
        instrument == experiment.instruments.end() ? 1.0 : std::max(instrument->second.quantum, 1e-9);
    std::size_t repeated = 0, split = 0, row = 0;
    Levels seen;
    for (const auto& [key, rows] : placements(experiment, run)) {
        std::vector<double> values;
        for (const std::size_t i : rows)
            if (!std::isnan(readings[i])) values.push_back(readings[i]);
        if (values.size() < kRepeats) continue;
        ++repeated;
        const Levels levels = levels_of(values, quantum);
        if (!levels.two) continue;
        if (split++ == 0) row = rows.front(), seen = levels;
    }
    if (split < kPlacements || static_cast<double>(split) < kLeastSplit * static_cast<double>(repeated))
        return;
    experiment.caution(
        "{}: {} falls into two levels, to and fro, at {} of {} placements ({:.4g} and {:.4g} where row {} "
        "is): rows of two robots mixed, or something that nobody noted was switched? Nothing that is found "
        "is to be believed before a column (unit) parts them",
        run.file, observable, split, repeated, seen.low, seen.high, row + 1);
}

}  // namespace

void check_mixed(Experiment& experiment) {
    for (Run& run : experiment.runs) {
        if (separated_by_unit(run)) continue;
        if (experiment.kind == Kind::Motion) check_paths(experiment, run);
        if (experiment.kind == Kind::Timing) check_frames(experiment, run);
        if (experiment.kind == Kind::Proximity || experiment.kind == Kind::Ground)
            check_levels(experiment, run, "reading");
        if (experiment.kind == Kind::Microphone) check_levels(experiment, run, "level");
    }
}

}  // namespace puckloop::gap
