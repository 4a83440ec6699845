#pragma once
// Range and bearing as emulated boards measure them: pairs of boards, each with its own spread of parts, on
// the stage at the distances of the published table.

#include "reproductions/rab/stage_node.h"

#include <csignal>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

struct RabMeasurement {
    std::filesystem::path firmware;  ///< image for both boards
    std::vector<double> distances;   ///< m
    int pairs = 6;                   ///< pairs of boards
    int repeats = 20;                ///< poses of each pair at each distance
    int power = 115;
    double turn = 0.024;       ///< s, as in StagePlan
    bool one_emitter = false;  ///< the same
    double poll_period = 0.0;  ///< the same
    std::uint64_t seed = 1;
    std::map<std::string, double> parameters{};  ///< physical ones, over the defaults
};

struct RabMeasured {
    std::vector<RabReadingRow> rows;
    double simulated_s = 0.0, wall_s = 0.0;
};

/// Throws InputError for an image that does not fit, RunError when a run fails or is interrupted.
RabMeasured measure_rab(const RabMeasurement& what, const std::function<void(double share)>& progress,
                        const volatile std::sig_atomic_t* interrupted);

}  // namespace puckloop::tools
