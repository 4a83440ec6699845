#pragma once
// What a run will cost in time, from what shipped scenarios cost and how fast this machine is.

#include "scenarios/description/scenario.h"

#include <optional>

namespace puckloop::tools {

struct CostEstimate {
    double one_process_s = 0.0;           ///< wall-clock seconds per simulated second, with --in-process
    double many_processes_s = 0.0;        ///< with a process per node
    std::optional<double> simulated_s{};  ///< the run's length; none: its programs end it
};

CostEstimate estimate_cost(const scenarios::Scenario& scenario);

}  // namespace puckloop::tools
