#pragma once
// The lines that a mission program is sent, and what it may answer (docs/missions.md).

#include "physics/tracker/mission_source.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::tools {

/// Version of what the lines mean.
inline constexpr int kMissionProtocol = 1;

std::string begin_line(const physics::World& world, const physics::TrackerSpec& tracker,
                       std::optional<double> duration);
/// `names` of the world's robots.
std::string frame_line(const physics::TrackerFrame& frame, const std::vector<std::string>& names,
                       std::span<const physics::Journal::Entry> done,
                       std::span<const physics::RefusedCommand> refused);
std::string end_line(double seconds);

struct MissionReply {
    physics::MissionAnswer answer{};
    std::optional<double> score{};  ///< none: as before
};
/// Throws InputError on what is no answer, or asks for what is no command.
MissionReply read_reply(std::string_view line);

}  // namespace puckloop::tools
