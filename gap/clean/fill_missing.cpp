#include "gap/clean/clean.h"

#include "gap/kinds/columns.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kMostLost = 0.5;  // share of a measurement

/// Drawn on between neighbours if `slow`, else held; before the first value the first holds.
void carry_on(std::vector<double>& values, bool slow) {
    const std::vector<double> given = values;
    std::size_t last = values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isnan(given[i])) {
            last = i;
            continue;
        }
        std::size_t next = i;
        while (next < given.size() && std::isnan(given[next]))
            ++next;
        if (last == values.size())
            values[i] = given[next];
        else if (slow && next < given.size())
            values[i] = given[last] + (given[next] - given[last]) * static_cast<double>(i - last) /
                                          static_cast<double>(next - last);
        else
            values[i] = given[last];
    }
}

/// Leaves out what was measured in these rows.
void blank(const Experiment& experiment, Run& run, const char* column, const std::vector<std::size_t>& rows) {
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        const bool event = info.high - info.low <= 1;
        if (info.role != Role::Observable || event || !run.has(info.name)) continue;
        auto& values = run.columns.at(info.name);
        const std::size_t there = stats::finite(values).size();
        for (const std::size_t i : rows)
            values[i] = std::nan("");
        const std::size_t lost = there - stats::finite(values).size();
        if (static_cast<double>(lost) > kMostLost * static_cast<double>(there))
            refuse(experiment, run,
                   fmt::format("{} is missing in {} of {} rows that have {}", column, lost, there, info.name),
                   "it in most rows, or no such column");
    }
}

/// Files by what was done about the cells missing in them.
using ByRemedy = std::map<std::string, std::vector<MissingIn>>;

void fill(Experiment& experiment, Run& run, const ColumnInfo& info, ByRemedy& files) {
    static const std::set<std::string_view> slow{"t_s", "temperature_c", "battery_v", "ambient_reading"};
    auto& values = run.columns.at(info.name);
    std::vector<std::size_t> gone;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (std::isnan(values[i])) gone.push_back(i);
    std::vector<double> given = stats::finite(values);
    if (gone.empty() || given.empty()) return;
    std::ranges::sort(given);
    std::string done;
    if (given.front() == given.back()) {
        std::ranges::fill(values, given.front());
        done = "filled with the run's only value";
    } else if (info.role == Role::Covariate) {
        carry_on(values, slow.contains(info.name));
        done = "filled in from the rows before and after";
    } else {
        blank(experiment, run, info.name, gone);
        if (experiment.kind == Kind::Rab || experiment.kind == Kind::Timing)
            std::ranges::replace_if(
                values, [](double value) { return std::isnan(value); }, given[given.size() / 2]);
        done = "which are left out";
    }
    files[done].push_back({run.file, gone.size(), run.rows});
}

}  // namespace

void fill_missing(Experiment& experiment) {
    if (experiment.kind == Kind::Motion) return;
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (info.role == Role::Observable || info.required) continue;
        ByRemedy by_remedy;
        for (Run& run : experiment.runs)
            if (run.has(info.name)) fill(experiment, run, info, by_remedy);
        for (const auto& [done, files] : by_remedy)
            experiment.cautions.push_back(missing_sentence(info.name, files, done));
    }
}

std::string missing_sentence(std::string_view column, const std::vector<MissingIn>& files,
                             std::string_view so) {
    if (files.empty()) return {};
    if (files.size() == 1)
        return fmt::format("{}: {} is missing in {} of {} rows, {}", files[0].file, column, files[0].missing,
                           files[0].rows, so);
    std::size_t missing = 0, rows = 0;
    for (const MissingIn& file : files) {
        missing += file.missing;
        rows += file.rows;
    }
    const auto [least, most] = std::ranges::minmax_element(files, {}, &MissingIn::missing);
    return fmt::format("{} is missing in {} of {} rows ({} runs), {}{}", column, missing, rows, files.size(),
                       so,
                       least->missing == most->missing
                           ? ""
                           : fmt::format("; most in {}: {} of {}", most->file, most->missing, most->rows));
}

}  // namespace puckloop::gap
