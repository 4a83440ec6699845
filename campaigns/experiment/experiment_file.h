#pragma once
// An experiment file: which programs under which conditions, how often (docs/swarm.md).

#include "base/json.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::swarm {

/// What differs between programs, or between conditions.
struct Variant {
    std::string name;
    int line = 0;                        ///< of its table, or of [experiment]
    std::vector<std::string> variables;  ///< "NAME=VALUE", of the scenario's [variables]
    std::vector<std::string> firmware;   ///< "BOARD=IMAGE"
    std::vector<std::string> program;  ///< Linux program and arguments of every robot; empty: the scenario's
    std::filesystem::path model;       ///< overlay of physical parameters; empty: none
};

struct Experiment {
    std::filesystem::path file, scenario;
    std::filesystem::path mission;              ///< file with [mission]; empty: the scenario's own
    std::filesystem::path floor;                ///< PNG file, of an ARGoS experiment; empty: none
    std::optional<double> duration;             ///< s
    std::optional<double> program_start;        ///< s
    std::vector<std::uint64_t> seeds;           ///< ascending, at least one
    std::string score = "/mission/score";       ///< JSON pointer into report.json
    std::optional<bool> more_is_better;         ///< none: as the mission's kind is
    bool keep = false;                          ///< the folder of every run
    std::vector<Variant> programs, conditions;  ///< at least one of each, names distinct
};

/// What the command line sets in place of the file.
struct Changes {
    int seeds = 0;        ///< seeds 1 to this number; 0: the file's
    double duration = 0;  ///< s; 0: the file's
};

/// Throws InputError with file and line.
Experiment read_experiment(const std::filesystem::path& file, const Changes& changes = {});

/// For the store and for workers.
nlohmann::json to_json(const Changes& changes);
Changes changes_from_json(const nlohmann::json& text);

/// One run of it.
struct Run {
    int id = 0;  ///< from 1: by program, then condition, then seed
    std::size_t program = 0, condition = 0;
    std::uint64_t seed = 1;
};

std::vector<Run> runs_of(const Experiment& experiment);

nlohmann::json to_json(const Run& run);
Run run_from_json(const nlohmann::json& text);

}  // namespace puckloop::swarm
