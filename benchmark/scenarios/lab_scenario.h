#pragma once
// Robots of a laboratory's swarm experiment, all in each other's light, for `puckloop bench --case lab20`.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

struct LabSpec {
    int robots = 20;
    std::filesystem::path main_image;
    std::filesystem::path rab_image;
    /// Every robot's; empty: the project's own, which asks its range-and-bearing board each 5 ms and sends 4
    /// bytes each 20 ms, varied by a tenth.
    std::vector<std::string> program;
    double start_s = 0.1;  ///< when the first program starts, simulated s
};

/// Twenty robots are in a dodecagon 2.46 m across between its sides, others in one with as much floor for
/// each. Programs start within 0.1 s of each other. Returns the file, which lies in `folder`.
std::filesystem::path write_lab_scenario(const std::filesystem::path& folder, const LabSpec& spec);

}  // namespace puckloop::tools
