#pragma once
// Runs of a mission, real or simulated: what they scored, and what their robots did.
//
// A folder of runs is results.csv (columns `program` and `run`; `score` and `condition` if there are any; one
// row per run) and a track of each: runs/RUN/trajectory.csv or RUN.csv, with the columns t_s, robot, x_m, y_m
// and, where the tracker gives it, theta_rad. The folder of `puckloop experiment` with `keep = true` is one.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::gap::mission {

/// One number a run says of behaviour; all of them are means over robots and time.
struct Statistic {
    std::string name, unit;
};

struct Run {
    std::string program, condition, name;
    std::vector<double> values;  ///< as MissionRuns::statistics; NaN where the run does not have it
};

struct MissionRuns {
    std::filesystem::path folder;
    std::vector<Statistic> statistics;
    std::vector<std::string> programs, conditions;  ///< in the order of the file
    std::vector<Run> runs;                          ///< those that did not fail
    std::size_t failed = 0;                         ///< rows without score and track
};

/// Those of a program under a condition; null: under any.
std::vector<const Run*> runs_of(const MissionRuns& all, const std::string& program,
                                const std::string* condition);
/// Throws InputError with file and line: no such file, a column that is missing, a run without a track, rows
/// that are no numbers, fewer than two runs of a program.
MissionRuns read_mission_runs(const std::filesystem::path& folder);

}  // namespace puckloop::gap::mission
