#pragma once
// The log of the world: what stands in it, who touches what and for how long, steps lost, batteries low,
// beams of booths interrupted by more than half.

#include "base/logs/node_log.h"
#include "physics/world/world_model.h"

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::physics {

class WorldLog {
  public:
    /// Opens description().recording.log and writes what stands where. Throws RunError as NodeLog does.
    explicit WorldLog(const WorldModel& world);

    void after_step(const WorldModel& world);
    /// A line about something else, at `seconds`.
    void note(double seconds, const std::string& text);
    /// Contacts that still last, poses, counts.
    void end(const WorldModel& world);

    /// A contact has ended when the bodies have been apart for this long (they bounce), in steps.
    static constexpr std::uint64_t kApart = 100;

  private:
    struct Episode {
        std::uint64_t begun = 0, last = 0;  // steps
    };
    struct Logged {
        std::array<std::uint64_t, 2> lost{};  // steps of each wheel
        bool battery_low = false;
    };
    void elements(const World& world);
    void contacts(const WorldModel& world);
    void drives(const WorldModel& world);
    void beams(const WorldModel& world);
    std::string name_of(const WorldModel& world, const RobotContact& contact) const;
    void write(const std::string& text) { log_.line(seconds_, text); }

    NodeLog log_;
    double seconds_ = 0.0;
    std::vector<std::string> robots_;
    std::map<RobotContact, Episode> touching_;
    std::vector<Logged> logged_;
    std::vector<std::array<bool, booth::kBarriers>> interrupted_;  // of each booth
    std::uint64_t ode_warnings_ = 0;
};

}  // namespace puckloop::physics
