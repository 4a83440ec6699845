#pragma once
// The stage on which two range-and-bearing boards are measured: it puts them at each distance in turn at
// random headings, lets one send a frame and then the other, and reads what each made of it, by I2C as a
// robot does.
//
// Ports: "poses" (to the infra-red medium's port "world"), "i2c0" and "i2c1" (to the boards' "i2c").

#include "base/random.h"
#include "cosim/core/node.h"
#include "physics/description/robot_constants.h"
#include "reproductions/rab/i2c_host.h"

#include <array>
#include <functional>
#include <map>
#include <memory>

namespace puckloop::tools {

struct StagePlan {
    std::vector<double> distances;              ///< between the bodies, m
    int repeats = 20;                           ///< poses at each distance, two frames each
    int power = 115;                            ///< potentiometer byte
    double body_radius = physics::kBodyRadius;  ///< m
    std::uint64_t seed = 1;                     ///< of the headings
    /// Time from power-up until the boards are ready, s.
    double boot = 0.1;
    double turn = 0.024;       ///< s between two poses
    bool one_emitter = false;  ///< a frame leaves by one emitter within 45 degrees of the line, not by all
    /// s between two polls of a host, each for one message; 0: a host asks after each frame until there is
    /// no other.
    double poll_period = 0.0;

    /// When all is measured, s.
    double duration() const;
};

/// One frame sent, and what the other board made of it.
struct RabReadingRow {
    std::size_t distance = 0;  ///< index of the plan's
    int sender = 0;
    int emitter = 0;            ///< 1..12, 0: all
    double bearing_true = 0.0;  ///< rad, of the sender as the receiver sees it
    double bearing_back = 0.0;  ///< rad, of the receiver as the sender sees it
    bool received = false;
    bool late = false;     ///< it came with a later frame
    int strays = 0;        ///< messages read meanwhile that nobody sent, or that had been read before
    int range = 0;         ///< register 5, 6
    double bearing = 0.0;  ///< rad, registers 3, 4, signed
};

class StageNode final : public cosim::Node {
  public:
    /// Rows go to `rows`, which must outlive the node.
    StageNode(const StagePlan& plan, std::vector<RabReadingRow>& rows);

    std::string_view name() const override { return "stage"; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;

  private:
    void pose(cosim::Time now, std::vector<cosim::Message>& outbox);
    int facing_emitter(double bearing);
    void send(int sender, cosim::Time now);
    void poll_again(int receiver, cosim::Time now);
    void poll(int receiver, cosim::Time now);
    void fetch(int receiver, cosim::Time now);
    void message(int receiver, cosim::Time now);
    void schedule(cosim::Time at, std::function<void(cosim::Time)> action);

    StagePlan plan_;
    std::vector<RabReadingRow>& rows_;
    std::vector<cosim::Port> ports_;
    RandomStream headings_, emitters_;
    std::array<I2cHost, 2> hosts_;
    std::array<double, 2> heading_{};
    std::size_t distance_ = 0;
    int repeat_ = 0;
    std::uint16_t payload_ = 0;
    cosim::Time next_pose_ = 0;  ///< kNever when done
    std::multimap<cosim::Time, std::function<void(cosim::Time)>> actions_;
    std::array<std::uint8_t, 7> registers_{};
};

}  // namespace puckloop::tools
