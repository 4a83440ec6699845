#include "gap/clean/clean.h"

#include "gap/kinds/columns.h"
#include "gap/stats/duplicates.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace puckloop::gap {

namespace {

using stats::Copy;
using stats::MeasuredRun;

constexpr double kWholeRun = 0.9;  // share of the later run's rows, for time series

std::vector<std::string> measured_columns(const Experiment& experiment) {
    std::vector<std::string> observables, truths;
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (!experiment.has(info.name)) continue;
        if (info.role == Role::Observable && info.high - info.low > 1) observables.emplace_back(info.name);
        if (info.role == Role::Truth) truths.emplace_back(info.name);
    }
    return observables.empty() ? truths : observables;
}

std::vector<MeasuredRun> measured_runs(const Experiment& experiment,
                                       const std::vector<std::string>& measured) {
    std::vector<MeasuredRun> runs;
    for (const Run& run : experiment.runs) {
        MeasuredRun m{run.name, {}, {}};
        // A run without a column that others have has nothing that could be a copy.
        for (const auto& name : measured)
            m.measured.push_back(run.has(name) ? run.column(name) : std::vector<double>(run.rows, NAN));
        for (const ColumnInfo& info : columns_of(experiment.kind))
            if (run.has(info.name) && (info.role == Role::Stimulus || info.role == Role::Truth))
                m.keys.push_back(run.column(info.name));
        runs.push_back(std::move(m));
    }
    return runs;
}

/// "row 3" or "rows 3-7"
std::string rows_text(std::size_t first, std::size_t count) {
    return count == 1 ? fmt::format("row {}", first + 1)
                      : fmt::format("rows {}-{}", first + 1, first + count);
}

std::string sentence(const Experiment& experiment, const Copy& copy) {
    const Run& first = experiment.runs[copy.run_a];
    const Run& second = experiment.runs[copy.run_b];
    const bool whole = copy.rows == second.rows && copy.rows == first.rows;
    const std::string what =
        whole
            ? fmt::format("run {} repeats run {}", second.name, first.name)
            : fmt::format("{} of run {} repeat{} {} of run {}", rows_text(copy.row_b, copy.rows), second.name,
                          copy.rows == 1 ? "s" : "", rows_text(copy.row_a, copy.rows), first.name);
    return what + " to the last digit: copied, not measured again; the later one is left out";
}

/// Rows that repeat the one before, clock and all: written twice.
void drop_twins(Experiment& experiment, Run& run) {
    const char* clock = run.has("t_s") ? "t_s" : "t_host_s";
    if (!run.has(clock)) return;
    std::set<std::size_t> twins;
    for (std::size_t i = 1; i < run.rows; ++i) {
        if (std::isnan(run.column(clock)[i])) continue;
        const bool same = std::all_of(run.columns.begin(), run.columns.end(), [i](const auto& column) {
            const double now = column.second[i], before = column.second[i - 1];
            return now == before || (std::isnan(now) && std::isnan(before));
        });
        if (same) twins.insert(i);
    }
    if (twins.empty()) return;
    experiment.caution("{}: {} of {} rows repeat the row before, clock included (row "
                       "{}): written twice; the later one is left out",
                       run.file, twins.size(), run.rows, *twins.begin() + 1);
    take_out(run, twins);
}

}  // namespace

void take_out(Run& run, const std::set<std::size_t>& rows) {
    for (auto& [name, values] : run.columns) {
        std::vector<double> kept;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!rows.contains(i)) kept.push_back(values[i]);
        values = std::move(kept);
    }
    run.rows -= rows.size();
}

void drop_copies(Experiment& experiment) {
    for (Run& run : experiment.runs)
        drop_twins(experiment, run);
    const std::vector<std::string> measured = measured_columns(experiment);
    if (measured.empty()) return;
    const bool series = experiment.kind == Kind::Motion || experiment.kind == Kind::Accelerometer ||
                        experiment.kind == Kind::Timing || experiment.kind == Kind::Described;
    std::vector<std::set<std::size_t>> gone(experiment.runs.size());
    for (const Copy& copy : copies_in(measured_runs(experiment, measured))) {
        const Run& later = experiment.runs[copy.run_b];
        if (series && static_cast<double>(copy.rows) < kWholeRun * static_cast<double>(later.rows)) continue;
        if (gone[copy.run_a].contains(copy.row_a) || gone[copy.run_b].contains(copy.row_b)) continue;
        for (std::size_t i = 0; i < copy.rows; ++i)
            gone[copy.run_b].insert(copy.row_b + i);
        experiment.cautions.push_back(sentence(experiment, copy));
    }
    for (std::size_t r = 0; r < gone.size(); ++r)
        if (!gone[r].empty()) take_out(experiment.runs[r], gone[r]);
    std::erase_if(experiment.runs, [](const Run& run) { return run.rows == 0; });
}

}  // namespace puckloop::gap
