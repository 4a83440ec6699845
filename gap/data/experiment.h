#pragma once
// A measured experiment as the analysis sees it: kind, nominal numbers, runs with conditions and a table of
// canonical columns in SI units. The format on disk is docs/gap.md; read_experiment() is its only reader.

#include "base/error.h"
#include "gap/kinds/instrument.h"
#include "gap/kinds/kind.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap {

class Problems;

/// One run: a table whose columns all have `rows` values; NaN = missing.
struct Run {
    std::string name;
    std::string file;                               ///< as experiment.toml names it, for messages
    std::map<std::string, std::string> conditions;  ///< "surface" -> "white"; the experiment's and the run's
    std::size_t rows = 0;
    std::map<std::string, std::vector<double>, std::less<>> columns;  ///< canonical names, SI units

    /// s: where each row's tracker time stands on the counters' clock; empty: the two are one
    /// (gap/sync/clocks).
    std::vector<double> counted_at;
    /// Rows at which a control loop that had paused began to count its periods anew (gap/sync/pauses).
    std::vector<std::size_t> begun_anew;

    /// The column, or an empty vector if this run does not have it.
    const std::vector<double>& column(std::string_view name) const;
    bool has(std::string_view name) const { return !column(name).empty(); }
    /// The condition's text, or "".
    std::string condition(const std::string& name) const;
};

/// Of a column that [columns] names: where the files have it, in which unit, and its line there.
struct Stated {
    std::string from, unit;
    int line = 0;
};

struct Experiment {
    Kind kind = Kind::Proximity;
    std::filesystem::path folder;
    std::string title, robot, description, source, licence;
    std::map<std::string, double> nominal;  ///< model parameter -> value, where not the simulator's default
    std::map<std::string, Instrument> instruments;      ///< by column
    std::map<std::string, Stated, std::less<>> stated;  ///< by column
    std::vector<Run> runs;
    std::vector<std::string> assumed;   ///< truth columns that nobody measured: nothing can be named on them
    std::vector<std::string> cautions;  ///< what the reader noticed, in plain words; part of the verdict

    std::size_t rows() const;  ///< over all runs
    /// What [nominal] says of a number, or `otherwise`.
    double nominal_or(const std::string& name, double otherwise) const;
    /// Does at least one run have this column?
    bool has(std::string_view column) const;
    /// Of a column's values over all runs.
    stats::Range range(std::string_view column) const;
    /// Adds a caution, formatted.
    template <class... Args>
    void caution(fmt::format_string<Args...> text, Args&&... args) {
        cautions.push_back(fmt::format(text, std::forward<Args>(args)...));
    }
};

/// Data that cannot be used, in one line with place, problem and remedy: throws InputError, which names the
/// run's file and, where `row` (from 0) is given, the row.
[[noreturn]] inline void refuse(const Experiment& experiment, const Run& run, const std::string& problem,
                                const std::string& expected, long row = -1) {
    throw InputError((experiment.folder / run.file).string(),
                     row < 0 ? std::string() : fmt::format("row {}", row + 1), problem, expected);
}

/// Of the experiment as a whole: its experiment.toml.
[[noreturn]] inline void refuse(const Experiment& experiment, const std::string& problem,
                                const std::string& expected) {
    throw InputError((experiment.folder / "experiment.toml").string(), "", problem, expected);
}

/// Reads `folder`/experiment.toml and the CSV files it names and converts units; nothing is judged. Problems
/// of files and columns go to `problems`; throws InputError where nothing can be read at all.
Experiment read_folder(const std::filesystem::path& folder, Problems& problems);

}  // namespace puckloop::gap
