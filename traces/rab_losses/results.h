#pragma once
// The losses of a run, from its results folder, as a table and as JSON.

#include "traces/rab_losses/losses.h"
#include "traces/rab_losses/phases.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Published figure for the share of frames that arrive: the e-puck infrastructure's technical report takes a
/// loss of 0.3 as realistic for simulations of two robots.
inline constexpr double kPublishedDelivered = 0.7;

struct RabResults {
    std::map<std::string, BoardTraffic> boards;  ///< by robot
    std::map<std::string, std::size_t> on_air;   ///< frames sent, by robot
    Losses losses;
    std::vector<PhaseLock> locked;
    double from_s = 0.0, to_s = 0.0;  ///< frames considered
};

/// Reads ir.csv and trace.csv of a run's results folder; frames that begin in [from_s, to_s). Throws
/// InputError for a folder without them or a line that cannot be read.
RabResults read_rab_results(const std::filesystem::path& folder, double from_s, double to_s);

/// Frames that have something in common.
struct RabGroup {
    std::string name;  ///< "robot0 -> robot1", "20 to 30 cm"
    std::size_t frames = 0, delivered = 0;
    double distance = 0.0;                        ///< m, mean
    std::array<std::size_t, kCauses> lost{};      ///< by cause
    std::array<std::size_t, kCauses> met{};       ///< frames that met a condition
    std::array<std::size_t, kCauses> met_lost{};  ///< and were lost, whatever the cause
    double share() const {
        return frames == 0 ? 0.0 : static_cast<double>(delivered) / static_cast<double>(frames);
    }
};

/// All frames; then one a pair of boards; then one for each `bin` (m) of distance.
std::vector<RabGroup> groups_of(const Losses& losses, double bin);

std::string to_text(const RabResults& results, double bin);
std::string to_json(const RabResults& results, double bin);

}  // namespace puckloop::tools
