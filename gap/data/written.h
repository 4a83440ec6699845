#pragma once
// An experiment to be written into the documented folder format (docs/gap.md): what importers, recorders and
// the generators of hidden effects fill in. Nothing here is shared with the reader.

#include <filesystem>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap {

struct WrittenColumn {
    std::string name;            ///< canonical name
    std::vector<double> values;  ///< NaN: an empty cell
    std::string unit{};          ///< as written under [columns]; "": the canonical one, not written
};

struct WrittenRun {
    std::string name{};                               ///< of the CSV file; "": run01, run02, ...
    std::map<std::string, std::string> conditions{};  ///< "light" -> "dark"
    std::map<std::string, double> constants{};        ///< canonical columns that are one number for the run
    std::string session{};                            ///< "": not known
    std::vector<WrittenColumn> columns{};

    WrittenColumn& column(std::string_view name, std::string_view unit = "1");  ///< made when absent
    /// One more value in each of these columns, in canonical units.
    void row(std::initializer_list<std::pair<const char*, double>> cells);
    const WrittenColumn* find(std::string_view name) const;
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().values.size(); }
};

struct WrittenInstrument {
    std::string column;
    double floor, ceiling;  ///< NaN: none
    double quantum = 0.0;
};

struct WrittenExperiment {
    std::string folder;                 ///< an importer's: its name under the output
    std::filesystem::path kind_file{};  ///< of a described kind: copied beside it; `kind` is then its name
    std::string kind, title = "bench test", robot = "e-puck", description, source, licence;
    bool brief = false;                     ///< a short look, too little for a verdict
    std::vector<std::string> assumed;       ///< truth columns that nobody measured
    std::map<std::string, double> nominal;  ///< model parameters of that robot
    std::vector<WrittenInstrument> instruments;
    std::vector<WrittenRun> runs;
};

std::string experiment_toml(const WrittenExperiment& experiment);

/// Writes experiment.toml and one CSV a run into the folder, which is made; `digits` of every value (0: as
/// many as bring the same double back). RunError if that fails.
void write_folder(const WrittenExperiment& experiment, const std::filesystem::path& folder, int digits = 9);

}  // namespace puckloop::gap
