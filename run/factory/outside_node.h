#pragma once
// What is plugged into a UART from outside the robot: a script, a pseudo terminal, a TCP client. 8N1.
//
// A script is part of the simulation. The others have a clock of their own: they are looked at once a
// simulated millisecond, the run is paced by the wall clock, and it cannot be repeated.

#include "cosim/core/node.h"
#include "ends/uart_end.h"
#include "run/description/outside_spec.h"

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

class OutsideNode : public cosim::Node {
  public:
    /// Throws InputError for an unreadable script, RunError if no terminal or port can be had. Prints on
    /// stderr where a terminal or port is.
    explicit OutsideNode(const OutsideSpec& spec);
    ~OutsideNode() override;

    std::string_view name() const override { return name_; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    /// Never: what a live end sends in answer is covered by its EOT, a script does not answer.
    cosim::Time lookahead(cosim::PortIndex /*port*/) const override { return cosim::kNever; }
    std::string finish() override;

  private:
    cosim::Time next_start() const;
    void look_outside(cosim::Time until);
    void send_before(cosim::Time until, std::vector<cosim::Message>& outbox);
    void receive(const cosim::UartFrame& frame);

    std::string name_;
    std::vector<cosim::Port> ports_{{"uart", cosim::PortKind::Uart}};
    std::unique_ptr<exec::UartEnd> end_;
    std::string record_name_;
    std::FILE* record_ = nullptr;
    cosim::Time bit_period_;
    cosim::Time free_ = 0;         // when the line to the robot is idle again
    cosim::Time heard_until_ = 0;  // when the receiver was done with the last character
    cosim::Time quiet_;
    cosim::Time next_look_ = 0;
    cosim::Time granted_ = 0;
    std::uint64_t sent_ = 0, received_ = 0, framing_errors_ = 0;
};

}  // namespace puckloop::tools
