#pragma once
// A model of the range-and-bearing board's register map on its I2C bus, with a simulated clock, for tests of
// the control program. Source: range-and-bearing fact sheet, sections 2.1, 2.2 and 2.4; written from the
// sheet, not from the driver. The map is the board's, with its oddities: the high part is never cleared, a
// run of registers gives the first one twice, reading register 0 takes a message.

#include "linuxboard/control/devices/clock.h"
#include "linuxboard/control/devices/i2c_device.h"

#include <array>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::control {

class SimulatedClock : public Clock {
  public:
    double now() override { return time; }
    void sleep_until(double until) override { time = until > time ? until : time; }
    double time = 0;
};

/// What the board has received and computed.
struct SimulatedMessage {
    std::uint32_t data = 0;
    std::int16_t bearing = 0;  ///< 1e-4 rad
    std::uint16_t strength = 0;
};

class SimulatedRab : public I2cDevice {
  public:
    using Payloads = std::array<std::optional<std::uint32_t>, 12>;
    struct Frame {
        Payloads payloads;
        double time = 0;
    };

    explicit SimulatedRab(SimulatedClock& clock) : clock_(clock) {}

    int transfer(std::span<const I2cMessage> messages) override;
    void receive(const SimulatedMessage& message);

    std::vector<Frame> frames;  ///< sent, payloads cut to the set size
    std::vector<std::pair<std::uint8_t, std::uint8_t>> writes;
    std::vector<double> polls;  ///< times at which register 0 was read
    int bits = 16;
    int range = 100;
    unsigned long transfers = 0;
    int refuse = 0;                     ///< so many transfers fail
    int error = 121;                    ///< with this errno value (EREMOTEIO)
    bool counts_like_the_board = true;  ///< false: a run gives r, r + 1, ... as a plain register file does
    std::size_t waiting() const { return queue_.size(); }

  private:
    void write_register(std::uint8_t number, std::uint8_t value);
    std::uint8_t read_register(unsigned number);
    void send(const Payloads& payloads);

    SimulatedClock& clock_;
    std::uint8_t pointer_ = 0;
    unsigned index_ = 0;
    bool first_ = true;
    std::uint32_t aux_ = 0;
    Payloads armed_;
    std::deque<SimulatedMessage> queue_;
    SimulatedMessage current_;
};

}  // namespace puckloop::control
