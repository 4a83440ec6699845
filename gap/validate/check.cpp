#include "gap/validate/checks.h"

#include "gap/clean/clean.h"
#include "gap/kinds/columns.h"
#include "gap/data/problems.h"
#include "gap/stats/robust.h"
#include "gap/validate/units.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kMostMissing = 0.5;  // share of missing cells beyond which a needed column is unusable
constexpr double kFewOutside = 0.02;  // share of implausible cells that may be outliers
constexpr std::size_t kFewRows = 30;
constexpr std::size_t kRunRows = 10;  // a run this long whose measurement never changes is odd
constexpr double kLongestGap = 1e7;   // s
constexpr double kManyClipped = 0.5, kMostClipped = 0.95;

std::size_t count_missing(const std::vector<double>& values) {
    return static_cast<std::size_t>(
        std::ranges::count_if(values, [](double value) { return std::isnan(value); }));
}

double furthest(const std::vector<double>& values) {
    double most = 0.0;
    for (const double value : values)
        if (std::abs(value) > std::abs(most)) most = value;
    return most;
}

/// Values that this quantity cannot have in its unit: a wrong unit or a swapped column. A few are glitches
/// and count as missing.
void check_range(Experiment& experiment, Run& run, const ColumnInfo& info) {
    auto& values = run.columns.at(info.name);
    const auto impossible = [&](double value) { return value < info.low || value > info.high; };
    const auto outside = std::ranges::count_if(values, impossible);
    if (outside == 0) return;
    const auto present = values.size() - count_missing(values);
    const auto first = std::ranges::find_if(values, impossible) - values.begin();
    const std::string value = fmt::format("{} = {:.6g}{}", info.name, values[static_cast<std::size_t>(first)],
                                          unit_suffix(info.unit));
    if (static_cast<double>(outside) >= kFewOutside * static_cast<double>(present))
        refuse(experiment, run,
               fmt::format("{} is impossible: wrong unit or swapped columns ({} of {} rows)", value, outside,
                           present),
               fmt::format("{:g} to {:g}{}{}", info.low, info.high, unit_suffix(info.unit),
                           unit_remedy(experiment, info, furthest(values))),
               first);
    experiment.caution("{}: {} in row {} is impossible ({} of {} rows): taken as missing", run.file, value,
                       first + 1, outside, present);
    std::ranges::replace_if(values, impossible, std::nan(""));
}

/// Columns that number something: between two of them is nothing.
bool is_index(const ColumnInfo& info) {
    static const std::set<std::string_view> names{"sensor", "mic",     "receiver", "emitter",
                                                  "object", "senders", "window"};
    return info.index || names.contains(info.name);
}

void check_index(const Experiment& experiment, const Run& run, const ColumnInfo& info) {
    const auto& values = run.column(info.name);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isnan(values[i]) && values[i] != std::round(values[i]))
            refuse(experiment, run, fmt::format("{} = {:.6g} is not whole", info.name, values[i]),
                   "whole numbers; or the columns are swapped", static_cast<long>(i));
}

/// Missing cells, in one caution for all runs.
void check_missing(Experiment& experiment, const ColumnInfo& info) {
    std::vector<MissingIn> files;
    for (const Run& run : experiment.runs) {
        const auto& values = run.column(info.name);
        const std::size_t gone = count_missing(values);
        if (gone == 0) continue;
        const double share = static_cast<double>(gone) / static_cast<double>(values.size());
        if (info.required && share > kMostMissing)
            refuse(experiment, run,
                   fmt::format("{} is missing in {} of {} rows", info.name, gone, values.size()),
                   info.role == Role::Truth ? "the truth in most rows" : "it in most rows");
        files.push_back({run.file, gone, values.size()});
    }
    if (files.empty()) return;
    if (info.required)
        experiment.cautions.push_back(missing_sentence(info.name, files, "which are left out"));
    else if (info.role != Role::Observable && experiment.kind == Kind::Motion)  // others: fill_missing()
        experiment.cautions.push_back(missing_sentence(info.name, files, "which are left out or filled in"));
}

/// A column without a single value holds nothing; it goes. One caution for all of them.
void drop_empty(Experiment& experiment) {
    std::map<std::string, std::vector<std::string>> columns;  // by where
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        std::size_t runs = 0;
        std::string where;
        for (Run& run : experiment.runs) {
            const auto& values = run.column(info.name);
            if (info.required || values.empty() || count_missing(values) < values.size()) continue;
            run.columns.erase(run.columns.find(info.name));
            where = ++runs == 1 ? run.file : fmt::format("{} runs", runs);
        }
        if (runs > 0) columns[where].emplace_back(info.name);
    }
    for (const auto& [where, names] : columns)
        experiment.caution("empty in every row of {}, taken as not recorded: {}", where,
                           fmt::join(names, ", "));
}

/// Readings beyond what the instrument can say tell next to nothing.
void check_clipped(Experiment& experiment, const ColumnInfo& info) {
    const auto instrument = experiment.instruments.find(info.name);
    if (instrument == experiment.instruments.end()) return;
    const std::vector<double> values = stats::finite(pooled(experiment, info.name));
    const auto clipped =
        std::ranges::count_if(values, [&](double value) { return instrument->second.at_end(value); });
    const double share =
        static_cast<double>(clipped) / static_cast<double>(std::max<std::size_t>(values.size(), 1));
    const std::string clipping =
        fmt::format("{} is at or beyond [instrument]'s floor or ceiling in {} of {} rows", info.name, clipped,
                    values.size());
    if (share > kMostClipped) refuse(experiment, clipping, "readings between the two");
    if (share > kManyClipped)
        experiment.cautions.push_back(clipping + ": such rows only say 'at least this far'");
}

/// A time that stands still or goes back; one long step forward is a gap, not an error.
void check_clock(Experiment& experiment, const Run& run, const char* name) {
    const auto& times = run.column(name);
    double last = std::nan("");
    std::vector<double> steps;
    for (std::size_t i = 0; i < times.size(); ++i) {
        if (std::isnan(times[i])) continue;
        if (times[i] < last)
            refuse(experiment, run, fmt::format("{} goes back from {:.6g} to {:.6g} s", name, last, times[i]),
                   "a clock that runs forward: one run a file", static_cast<long>(i));
        if (!std::isnan(last)) steps.push_back(times[i] - last);
        last = times[i];
    }
    if (steps.empty()) return;
    std::ranges::sort(steps);
    const double usual = steps[steps.size() / 2], longest = steps.back();
    if (longest <= 0) {
        if (experiment.kind == Kind::Motion || experiment.kind == Kind::Timing)
            refuse(experiment, run, fmt::format("the clock {} stands still", name), "a time for every row");
        experiment.caution("{}: the clock {} stands still: what depends on time cannot be seen", run.file,
                           name);
    }
    if (longest > kLongestGap)
        refuse(experiment, run, fmt::format("{} jumps by {:.3g} s", name, longest), "seconds");
    if (steps.size() >= 10 && usual > 0 && longest > 50 * usual && longest > 1.0)
        experiment.caution("{}: the clock {} jumps by {:.3g} s (a step is {:.3g} s): "
                           "rows before and after are not taken as neighbours",
                           run.file, name, longest, usual);
}

/// Constant over the whole experiment, where something must change to learn anything.
void check_constant(Experiment& experiment, const ColumnInfo& info) {
    const auto [low, high] = experiment.range(info.name);
    if (low != high) return;
    if (info.role == Role::Observable && std::string_view(info.unit) != "1")
        refuse(experiment, fmt::format("{} is {:g} in every row of every run", info.name, low),
               "a measurement that changes");
    if (info.role == Role::Observable)
        experiment.caution("{} is {:g} in every row: nothing made it otherwise", info.name, low);
    else if (info.role != Role::Covariate)
        experiment.caution("{} is {:g}{} in every row: nothing can be learnt about what depends on it",
                           info.name, low, unit_suffix(info.unit));
}

/// A measurement that never changes inside one run while it does in others: a sensor that hung.
void check_hung(Experiment& experiment, const ColumnInfo& info) {
    if (info.role != Role::Observable || std::string_view(info.unit) == "1") return;
    for (const Run& run : experiment.runs) {
        const auto& values = run.column(info.name);
        if (run.rows < kRunRows || values.empty()) continue;
        if (std::ranges::any_of(values, [&](double value) { return value != values.front(); })) continue;
        experiment.caution("{}: {} is {:g}{} in every row of this run: did it hang?", run.file, info.name,
                           values.front(), unit_suffix(info.unit));
    }
}

void check_runs(Experiment& experiment) {
    if (experiment.rows() < kFewRows)
        experiment.caution(
            "there are only {} rows: that nothing is found in so few does not mean that there is nothing",
            experiment.rows());
    if (experiment.runs.size() == 1)
        experiment.cautions.push_back("there is one run only: nothing can be held out whole, intervals come "
                                      "from blocks of the run and say nothing about another day");
    else if (experiment.runs.size() < 4)
        experiment.caution("there are only {} runs: intervals over runs are wide and uncertain",
                           experiment.runs.size());
    const std::vector<double> named = stats::finite(pooled(experiment, "unit"));
    const std::set<double> units(named.begin(), named.end());
    if (units.size() > 1)
        experiment.caution("{} robots are mixed: what is found is common to them; a "
                           "difference between robots shows as structure against unit",
                           units.size());
}

/// A file by any of its names: "./run1.csv", a link.
void check_files(const Experiment& experiment) {
    std::map<std::filesystem::path, std::string> files;
    std::error_code failed;
    for (const Run& run : experiment.runs) {
        auto path = std::filesystem::canonical(experiment.folder / run.file, failed);
        if (failed) path = experiment.folder / run.file;
        const auto [first, fresh] = files.emplace(path, run.file);
        if (fresh) continue;
        const std::string names = first->second == run.file
                                      ? run.file
                                      : fmt::format("{}, also written {},", first->second, run.file);
        refuse(experiment, names + " is named by two runs", "each file once");
    }
}

}  // namespace

void check(Experiment& experiment, Problems& problems) {
    const auto step = [&](const auto& what) { return problems.attempt(what); };
    step([&] { check_files(experiment); });
    step([&] { check_nominal(experiment); });
    drop_empty(experiment);
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (!experiment.has(info.name)) continue;
        for (Run& run : experiment.runs)
            if (run.has(info.name)) {
                step([&] { check_range(experiment, run, info); });
                if (is_index(info)) step([&] { check_index(experiment, run, info); });
            }
        step([&] { check_missing(experiment, info); });
        step([&] { check_constant(experiment, info); });
        check_hung(experiment, info);
        step([&] { check_clipped(experiment, info); });
    }
    for (const Run& run : experiment.runs)
        for (const char* clock : {"t_s", "t_host_s", "t_robot_s"})
            if (run.has(clock)) step([&] { check_clock(experiment, run, clock); });
    if (!problems.empty()) return;
    step([&] {
        drop_repeats(experiment);  // before cells are filled, which then differ in rows that were alike
        fill_missing(experiment);
        drop_copies(experiment);
        check_runs(experiment);
        check_mixed(experiment);
        check_kind(experiment);
        check_units(experiment);
    });
}

}  // namespace puckloop::gap
