#pragma once
// The tracker above a running world: its frames are recorded, and go to a mission program when they arrive.
// What that asks for joins the commands of others.

#include "cosim/core/node.h"
#include "physics/events/command_source.h"
#include "physics/tracker/mission_source.h"
#include "physics/tracker/tracker_record.h"
#include "physics/world/world_model.h"

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::physics {

struct TrackerPlan {
    TrackerSpec spec{};
    std::unique_ptr<MissionSource> mission{};  ///< nullptr: nobody listens
};

class Overhead final : public CommandSource {
  public:
    /// `others`: commands from elsewhere, may be null. Throws RunError if tracker.csv cannot be written.
    Overhead(TrackerPlan plan, std::unique_ptr<CommandSource> others, const WorldModel& model);

    /// In each step once, when its bodies have moved and before events; `journal` is what was done until
    /// then.
    void at_step(const WorldModel& model, const Journal& journal);
    /// Set once the mission program ends the run, or cannot go on.
    const std::optional<cosim::Stop>& stop() const { return stop_; }
    /// The mission program's part of the report as JSON text; empty without one.
    std::string finish(double seconds);

    std::vector<Command> poll() override;
    void reply(std::uint64_t id, const std::string& json) override;

  private:
    void take(MissionAnswer answer, std::uint64_t step);

    TrackerPlan plan_;
    std::unique_ptr<CommandSource> others_;
    Tracker tracker_;
    std::optional<TrackerRecord> record_;
    std::vector<RobotState> robots_;  // scratch
    std::deque<TrackerFrame> under_way_;
    std::vector<Action> asked_;                     // not yet polled
    std::map<std::uint64_t, std::string> waiting_;  // the mission program's commands, by id
    std::vector<RefusedCommand> refused_;
    std::size_t reported_ = 0;  // entries of the journal
    std::uint64_t last_id_ = 0;
    std::optional<cosim::Stop> stop_;
};

}  // namespace puckloop::physics
