#pragma once
// The physical world as a node: wheel counts in, sensor signals out, one step per millisecond.
//
// Ports, in the order of the description's robots: "<robot>.board" and "<robot>.ground", both signals; ids
// come from each robot's board_signals and ground_signals. Then, if any robot has a range-and-bearing board,
// "ir": poses for the infra-red medium (physics/world/pose_signals.h), and "<robot>.rab" of each such board:
// the battery's voltage in steps of 10 mV. Then "<booth>" of each booth: barriers out, coloured LEDs in. Then
// "<robot>.camera" of each robot with cameras: what they see, shortly before each frame
// (physics/camera/camera_signals.h). Before those, if there is a network, "messages": datagrams that events
// send to its computers. Step k (state at k ms) uses what was stamped before k ms; its sensor values and
// poses leave stamped (k+1) ms, only those that changed, rounded to world.publish_quantum, or for poses to 10
// um and 0.1 mrad. What happens to the world meanwhile: physics/events.

#include "cosim/core/node.h"
#include "physics/description/description.h"
#include "physics/dynamics/step_observer.h"
#include "physics/events/command_source.h"
#include "physics/tracker/overhead.h"

#include <memory>
#include <optional>

namespace puckloop::physics {

/// Media beside those of the description that hear where everything is, each at a port with the same poses as
/// "ir".
struct PosePorts {
    bool bluetooth = false;  ///< "bluetooth"
    bool network = false;    ///< "network"
};

class WorldNode final : public cosim::Node {
  public:
    /// Throws InputError on an impossible world, RunError when recordings cannot be written.
    explicit WorldNode(World description) : WorldNode(std::move(description), {}, nullptr) {}
    /// With what happens to it, and where commands come from if the plan has any. Throws as check_events()
    /// too.
    /// With a mission program the plan states so (EventPlan::mission).
    WorldNode(World description, EventPlan plan, std::unique_ptr<CommandSource> commands,
              PosePorts media = {}, std::optional<TrackerPlan> tracker = {});
    ~WorldNode() override;

    std::string_view name() const override;
    std::span<const cosim::Port> ports() const override;
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// The mission program's (physics/tracker/mission_source.h).
    std::optional<cosim::Stop> stop() const override;
    std::string finish() override;

    /// Hears of every part of the steps to come; nullptr: nobody does.
    void observe(StepObserver* observer);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace puckloop::physics
