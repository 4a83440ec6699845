#pragma once
// An experiment on its way into the documented folder format (docs/gap.md): what importers fill in.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap::importers {

struct ImportedRun {
    std::string name;                               ///< becomes the CSV file's name
    std::map<std::string, std::string> conditions;  ///< "light" -> "dark"
    std::map<std::string, double> constants;        ///< canonical columns that are one number for the run
    std::string session;                            ///< empty: not known
    std::vector<std::pair<std::string, std::vector<double>>> columns;  ///< canonical names, SI units
};

struct ImportedInstrument {
    std::string column;
    double floor, ceiling;  ///< NaN: none
    double quantum = 0.0;
};

struct ImportedExperiment {
    std::string folder;  ///< name of its folder under the output
    std::string kind, title, robot, description, source, licence;
    std::vector<std::string> assumed;       ///< truth columns that the set does not hold
    std::map<std::string, double> nominal;  ///< model parameters of that robot
    std::vector<ImportedInstrument> instruments;
    std::vector<ImportedRun> runs;
};

/// InputError where out/folder holds an experiment.toml that this import would not write as it is.
void refuse_edited(const ImportedExperiment& experiment, const std::filesystem::path& out);

/// Writes experiment.toml and one CSV a run into out/folder, which is made. Throws RunError if that fails.
void write_experiment(const ImportedExperiment& experiment, const std::filesystem::path& out);

}  // namespace puckloop::gap::importers
