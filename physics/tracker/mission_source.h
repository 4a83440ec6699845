#pragma once
// Who judges a run by what the tracker sees, and acts on the world: whoever implements it has the program.

#include "physics/events/journal.h"
#include "physics/tracker/tracker.h"

#include <span>
#include <string>
#include <vector>

namespace puckloop::physics {

/// A command of the mission program that the world did not carry out.
struct RefusedCommand {
    std::string command, why;
    cosim::Time time = 0;
};

struct MissionAnswer {
    std::vector<Action> acts{};  ///< done one step (1 ms) later
    bool end = false;            ///< the run is to end
    bool failed = false;         ///< it ends without success
    std::string why{};           ///< of either, one line
};

class MissionSource {
  public:
    virtual ~MissionSource() = default;
    /// At time 0, before anything moves.
    virtual MissionAnswer begin(const World& world, const TrackerSpec& tracker) = 0;
    /// When a frame arrives, with what was done to the world, and refused, since the one before.
    virtual MissionAnswer frame(const TrackerFrame& frame, std::span<const Journal::Entry> done,
                                std::span<const RefusedCommand> refused) = 0;
    /// The run is over, `seconds` after its beginning. Returns the mission program's part of the report as
    /// JSON text.
    virtual std::string end(double seconds) = 0;
};

}  // namespace puckloop::physics
