#pragma once
// Range and bearing against density: how many of its neighbours' frames a board gets, for teams of several
// sizes in the dodecagon of the published swarm experiments, payloads and distances.
//
// Robots stand where they were drawn; each sends every 20 ms or so, as the field's program for real robots
// does, and polls its board every 5 ms.

#include "traces/rab_losses/losses.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace puckloop::tools {

inline constexpr int kMostOfDensity = 40;
/// Edges of the classes of distance, m; calibrations are about neighbours below kNeighbour.
inline constexpr std::array<double, 5> kDensityEdges{0.0, 0.25, 0.5, 0.75, 1.0};
inline constexpr double kNeighbour = 0.5;
/// s: what such a calibration calls a step.
inline constexpr double kDensityStep = 0.1;
/// Share of steps in which a neighbour is heard, as laboratories set their simulators: two robots (loss of a
/// packet 0.3, technical report of the infrastructure), twenty (0.85; 0.90 in a pseudo-reality).
inline constexpr double kPublishedOfTwo = 0.7, kPublishedOfTwenty = 0.15, kPublishedLow = 0.10;

struct DensitySpec {
    std::filesystem::path folder;    ///< of the scenario and its results
    std::filesystem::path firmware;  ///< of the range-and-bearing boards
    int robots = 20;
    int bytes = 4;  ///< of a payload: 1, 2 or 4
    double emit_ms = 20.0, poll_ms = 5.0;
    double seconds = 1.0;  ///< that count
    std::uint64_t seed = 1;
    std::map<std::string, double> parameters{};  ///< physical ones, over the defaults
};

/// Frames from boards at such a distance.
struct DensityClass {
    std::size_t frames = 0, heard = 0;
    std::size_t steps = 0, steps_heard = 0;  ///< of pairs: in how many of them anything was
    std::array<std::size_t, kCauses> lost{};

    double share() const {
        return frames == 0 ? 0.0 : static_cast<double>(heard) / static_cast<double>(frames);
    }
    double share_of_steps() const {
        return steps == 0 ? 0.0 : static_cast<double>(steps_heard) / static_cast<double>(steps);
    }
    void add(const DensityClass& other);
};

struct Density {
    std::array<DensityClass, kDensityEdges.size() - 1> classes{};
    DensityClass neighbours{};  ///< below kNeighbour
    void add(const Density& other);
};

/// Of frames that begin in [from_s, to_s), of robots that stand.
Density density_of(const std::vector<Fate>& fates, double from_s, double to_s);

/// One run. Throws InputError for an image or parameter that does not fit, RunError where it did not reach
/// its end.
Density run_density(const DensitySpec& spec);

/// One team's size and payload under one set of parameters.
struct DensityRow {
    std::string setting;
    int robots = 0, bytes = 0, runs = 0;
    Density density{};
};
std::string density_table(const std::vector<DensityRow>& rows);
std::string density_csv(const std::vector<DensityRow>& rows);
/// Share of steps in which a neighbour is heard against the team's size, beside the published ones, as SVG.
std::string density_picture(const std::vector<DensityRow>& rows, const std::string& caption);

}  // namespace puckloop::tools
