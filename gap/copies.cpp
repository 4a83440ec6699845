#include "gap/copies.h"

#include "gap/columns.h"
#include "gap/stats/duplicates.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::gap {

namespace {

using stats::Copy;
using stats::MeasuredRun;

constexpr double kWholeRun = 0.9;  // share of the later run's rows, for time series

bool in_every_run(const Experiment& experiment, std::string_view column) {
    return std::all_of(experiment.runs.begin(), experiment.runs.end(),
                       [column](const Run& run) { return run.has(column); });
}

std::vector<std::string> measured_columns(const Experiment& experiment) {
    std::vector<std::string> observables, truths;
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (!in_every_run(experiment, info.name)) continue;
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
        for (const auto& name : measured)
            m.measured.push_back(run.column(name));
        for (const ColumnInfo& info : columns_of(experiment.kind))
            if (run.has(info.name) && (info.role == Role::Stimulus || info.role == Role::Truth))
                m.keys.push_back(run.column(info.name));
        runs.push_back(std::move(m));
    }
    return runs;
}

void take_out(Run& run, const std::set<std::size_t>& rows) {
    for (auto& [name, values] : run.columns) {
        std::vector<double> kept;
        for (std::size_t i = 0; i < values.size(); ++i)
            if (!rows.contains(i)) kept.push_back(values[i]);
        values = std::move(kept);
    }
    run.rows -= rows.size();
}

std::string sentence(const Experiment& experiment, const Copy& copy) {
    const Run& first = experiment.runs[copy.run_a];
    const Run& second = experiment.runs[copy.run_b];
    const bool whole = copy.rows == second.rows;
    const std::string later =
        whole ? fmt::format("run {}", second.name)
              : fmt::format("row {}{} of run {}", copy.row_b + 1,
                            copy.rows > 1 ? fmt::format("-{}", copy.row_b + copy.rows) : "", second.name);
    const std::string earlier = copy.rows == first.rows
                                    ? fmt::format("run {}", first.name)
                                    : fmt::format("run {} from row {} on", first.name, copy.row_a + 1);
    return fmt::format(
        "{} repeats {} to the last digit in {} row{}: copied, not measured again; it is left out", later,
        earlier, copy.rows, copy.rows == 1 ? "" : "s");
}

}  // namespace

void drop_copies(Experiment& experiment) {
    const std::vector<std::string> measured = measured_columns(experiment);
    if (measured.empty()) return;
    const bool series = experiment.kind == Kind::Motion || experiment.kind == Kind::Accelerometer ||
                        experiment.kind == Kind::Timing;
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
