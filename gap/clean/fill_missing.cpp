#include "gap/clean/fill_missing.h"

#include "base/error.h"
#include "gap/data/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kMostLost = 0.5;  // share of a measurement
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Drawn on between neighbours if `slow`, else held; before the first value the first holds.
void carry_on(std::vector<double>& values, bool slow) {
    const std::vector<double> known = values;
    std::size_t last = values.size();
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isnan(known[i])) {
            last = i;
            continue;
        }
        std::size_t next = i;
        while (next < known.size() && std::isnan(known[next]))
            ++next;
        if (last == values.size())
            values[i] = known[next];
        else if (slow && next < known.size())
            values[i] = known[last] + (known[next] - known[last]) * static_cast<double>(i - last) /
                                          static_cast<double>(next - last);
        else
            values[i] = known[last];
    }
}

/// Leaves out what was measured in these rows.
void blank(const Experiment& experiment, Run& run, const char* missing,
           const std::vector<std::size_t>& rows) {
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        const bool event = info.high - info.low <= 1;
        if (info.role != Role::Observable || event || !run.has(info.name)) continue;
        auto& values = run.columns.at(info.name);
        const auto there =
            std::count_if(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
        double lost = 0.0;
        for (const std::size_t i : rows) {
            lost += std::isnan(values[i]) ? 0 : 1;
            values[i] = kNothing;
        }
        if (lost > kMostLost * static_cast<double>(there))
            throw InputError(
                (experiment.folder / run.file).string(), "",
                fmt::format("{} is missing in {} of {} rows that have {}", missing, lost, there, info.name),
                "it in most rows, or no such column");
    }
}

/// Files by what was done about the cells missing in them.
using ByRemedy = std::map<std::string, std::vector<MissingIn>>;

void fill(Experiment& experiment, Run& run, const ColumnInfo& info, ByRemedy& files) {
    static const std::set<std::string_view> slow{"t_s", "temperature_c", "battery_v", "ambient_reading"};
    auto& values = run.columns.at(info.name);
    std::vector<std::size_t> missing;
    std::vector<double> known;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (std::isnan(values[i]))
            missing.push_back(i);
        else
            known.push_back(values[i]);
    if (missing.empty() || known.empty()) return;
    std::sort(known.begin(), known.end());
    std::string done;
    if (known.front() == known.back()) {
        std::fill(values.begin(), values.end(), known.front());
        done = "filled with the run's only value";
    } else if (info.role == Role::Covariate) {
        carry_on(values, slow.contains(info.name));
        done = "filled in from the rows before and after";
    } else {
        blank(experiment, run, info.name, missing);
        const double usual = known[known.size() / 2];
        if (experiment.kind == Kind::Rab || experiment.kind == Kind::Timing)
            for (const std::size_t i : missing)
                values[i] = usual;
        done = "which are left out";
    }
    files[done].push_back({run.file, missing.size(), run.rows});
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
    const auto [least, most] =
        std::minmax_element(files.begin(), files.end(),
                            [](const MissingIn& a, const MissingIn& b) { return a.missing < b.missing; });
    return fmt::format("{} is missing in {} of {} rows ({} runs), {}{}", column, missing, rows, files.size(),
                       so,
                       least->missing == most->missing
                           ? ""
                           : fmt::format("; most in {}: {} of {}", most->file, most->missing, most->rows));
}

}  // namespace puckloop::gap
