#include "gap/check.h"

#include "base/error.h"
#include "gap/check_kinds.h"
#include "gap/columns.h"
#include "gap/copies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kMostMissing = 0.5;  // share of missing cells beyond which a needed column is unusable
constexpr double kFewOutside = 0.02;  // share of implausible cells that may be outliers

std::string place_of(const Experiment& experiment, const Run& run) {
    return (experiment.folder / run.file).string();
}

/// Values that this quantity cannot have in its unit: a wrong unit or a swapped column.
void check_range(const Experiment& experiment, const Run& run, const ColumnInfo& info) {
    const auto& values = run.column(info.name);
    std::size_t outside = 0, present = 0, first = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (std::isnan(values[i])) continue;
        ++present;
        if (values[i] >= info.low && values[i] <= info.high) continue;
        if (outside++ == 0) first = i;
    }
    if (outside == 0 || static_cast<double>(outside) < kFewOutside * static_cast<double>(present)) return;
    throw InputError(
        place_of(experiment, run), fmt::format("row {}", first + 1),
        fmt::format("{} = {:.6g} {} is impossible: wrong unit or swapped columns ({} of {} rows)", info.name,
                    values[first], info.unit, outside, present),
        fmt::format("{:g} to {:g} {}", info.low, info.high, info.unit));
}

void check_missing(Experiment& experiment, const Run& run, const ColumnInfo& info) {
    const auto& values = run.column(info.name);
    const auto missing =
        std::count_if(values.begin(), values.end(), [](double value) { return std::isnan(value); });
    if (missing == 0) return;
    const double share = static_cast<double>(missing) / static_cast<double>(values.size());
    if (info.required && share > kMostMissing)
        throw InputError(place_of(experiment, run), "",
                         fmt::format("{} is missing in {} of {} rows", info.name, missing, values.size()),
                         info.role == Role::Truth ? "the truth in most rows" : "it in most rows");
    if (info.required)
        experiment.cautions.push_back(fmt::format("{}: {} is missing in {} of {} rows, which are left out",
                                                  run.file, info.name, missing, values.size()));
}

/// A time that stands still or goes back; one long step forward is a gap, not an error.
void check_clock(Experiment& experiment, const Run& run, const char* name) {
    const auto& times = run.column(name);
    double last = std::nan("");
    std::vector<double> steps;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (std::isnan(times[i])) continue;
        if (times[i] < last)
            throw InputError(place_of(experiment, run), fmt::format("row {}", i + 1),
                             fmt::format("{} goes back from {:.6g} to {:.6g} s", name, last, times[i]),
                             "a clock that runs forward: one run a file");
        if (!std::isnan(last)) steps.push_back(times[i] - last);
        last = times[i];
    }
    if (steps.size() < 10) return;
    std::sort(steps.begin(), steps.end());
    const double usual = steps[steps.size() / 2];
    const double longest = steps.back();
    if (usual > 0 && longest > 50 * usual && longest > 1.0)
        experiment.cautions.push_back(fmt::format(
            "{}: the clock {} jumps by {:.3g} s (a step is {:.3g} s): rows before and after are not "
            "taken as neighbours",
            run.file, name, longest, usual));
}

/// Constant over the whole experiment, where something must change to learn anything.
void check_constant(Experiment& experiment, const ColumnInfo& info) {
    double low = INFINITY, high = -INFINITY;
    for (const Run& run : experiment.runs)
        for (const double value : run.column(info.name))
            if (!std::isnan(value)) {
                low = std::min(low, value);
                high = std::max(high, value);
            }
    if (!(low >= high)) return;
    if (info.role == Role::Observable && std::string_view(info.unit) != "1")
        throw InputError((experiment.folder / "experiment.toml").string(), "",
                         fmt::format("{} is {:g} in every row of every run", info.name, low),
                         "a measurement that changes");
    if (info.role != Role::Covariate)
        experiment.cautions.push_back(
            fmt::format("{} is {:g} {} in every row: nothing can be learnt about what depends on it",
                        info.name, low, std::string_view(info.unit) == "1" ? "" : info.unit));
}

void check_runs(Experiment& experiment) {
    if (experiment.runs.size() == 1)
        experiment.cautions.push_back(
            "there is one run only: nothing can be held out whole, intervals come from blocks of the run and "
            "say nothing about another day");
    else if (experiment.runs.size() < 4)
        experiment.cautions.push_back(fmt::format(
            "there are only {} runs: intervals over runs are wide and uncertain", experiment.runs.size()));
    std::set<double> units;
    for (const Run& run : experiment.runs)
        for (const double value : run.column("unit"))
            if (!std::isnan(value)) units.insert(value);
    if (units.size() > 1)
        experiment.cautions.push_back(fmt::format(
            "{} robots are mixed: what is found is common to them; a difference between robots shows as "
            "structure against unit",
            units.size()));
    std::set<std::string> files;
    for (const Run& run : experiment.runs)
        if (!files.insert(run.file).second)
            throw InputError((experiment.folder / "experiment.toml").string(), "",
                             fmt::format("{} is named by two runs", run.file), "each file once");
}

}  // namespace

void check(Experiment& experiment) {
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (!experiment.has(info.name)) continue;
        for (const Run& run : experiment.runs)
            if (run.has(info.name)) {
                check_missing(experiment, run, info);
                check_range(experiment, run, info);
            }
        check_constant(experiment, info);
    }
    for (const Run& run : experiment.runs)
        for (const char* clock : {"t_s", "t_host_s", "t_robot_s"})
            if (run.has(clock)) check_clock(experiment, run, clock);
    drop_copies(experiment);
    check_runs(experiment);
    check_kind(experiment);
}

}  // namespace puckloop::gap
