#pragma once
// `puckloop gap mission`: measured runs of a mission beside an experiment's, and what is said of them.

#include "gap/mission/compare.h"
#include "gap/mission/runs.h"

#include <string>
#include <vector>

namespace puckloop::gap::mission {

struct MissionVerdict {
    Comparison comparison;
    std::vector<std::string> programs;  ///< that both sides have, as Difference::program counts them
    std::vector<Statistic> statistics;  ///< that were compared, as Difference::statistic counts them
    std::vector<std::string> effects;   ///< conditions of the experiment but the first
    std::string base;                   ///< the first condition
    std::vector<std::string> cautions;  ///< what was left out, and why
    std::size_t measured_runs = 0, simulated_runs = 0;
};

/// `simulated` has the conditions: the first is the simulation as it is, every other one effect. Measured
/// conditions are not looked at. Throws InputError where no program is on both sides.
MissionVerdict judge(const MissionRuns& measured, const MissionRuns& simulated, std::uint64_t seed);

/// One or two sentences.
std::string summary_of(const MissionVerdict& verdict);
/// All of it for a terminal.
std::string verdict_text(const MissionVerdict& verdict);
/// gap_mission.json; docs/swarm.md explains it. Same verdict, same bytes.
std::string verdict_json(const MissionVerdict& verdict);

}  // namespace puckloop::gap::mission
