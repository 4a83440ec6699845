#pragma once
// An experiment as the generator of hidden effects makes it: plain tables, and the folder they are written to
// (docs/gap.md). Nothing here is shared with the tool's own reader.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap::selftest {

struct HiddenColumn {
    std::string name;            ///< canonical name, docs/gap.md
    std::string unit;            ///< as written in experiment.toml
    std::vector<double> values;  ///< NaN = an empty cell
};

struct HiddenRun {
    std::map<std::string, std::string> conditions;
    std::vector<HiddenColumn> columns;

    HiddenColumn& column(std::string_view name, std::string_view unit = "1");  ///< made when absent
    const HiddenColumn* find(std::string_view name) const;
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

struct HiddenExperiment {
    std::string kind;
    std::vector<std::pair<std::string, std::string>> nominal;     ///< model parameter and TOML value
    std::vector<std::pair<std::string, std::string>> instrument;  ///< column and TOML inline table
    std::vector<HiddenRun> runs;
};

/// Writes experiment.toml and run01.csv, run02.csv, ... Nothing in them tells what was hidden.
void write_folder(const HiddenExperiment& experiment, const std::filesystem::path& folder);

}  // namespace puckloop::gap::selftest
