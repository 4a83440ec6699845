#pragma once
// The range-and-bearing board (e-RandB) as its Linux board sees it: set-up, messages in, messages out, each
// as one bus operation. Source: range-and-bearing fact sheet, sections 2.1 to 2.4 and 4.8.
//
// It differs from the known drivers on purpose:
//  * Bearings are signed (they take them for unsigned, which turns each negative one by 15.5 degrees).
//  * Different data for different emitters is stored first and sent once, not once an emitter.
//  * An operation is one transfer with repeated starts: the robot's PIC, the other master of the bus, cannot
//    move the board's register pointer in between.
//  * Failed transfers are tried again a few times and counted, never for ever; those that timed out are not.

#include "linuxboard/control/devices/clock.h"
#include "linuxboard/control/devices/i2c_device.h"
#include "linuxboard/control/rab/rab_registers.h"

#include <array>
#include <optional>

namespace puckloop::control {

struct RabBoardSettings {
    int bytes = 2;                   ///< payload, 1..4; the same on all robots
    int range = rab::kDefaultRange;  ///< 0 farthest .. 255 shortest
    int tries = 4;                   ///< of each transfer
    bool burst = false;              ///< read a message as one run of registers; see read_burst
};

struct RabPacket {
    std::uint32_t payload = 0;
    double bearing = 0;   ///< rad, -pi..pi, counter-clockwise from straight ahead
    double strength = 0;  ///< the board's "range": the bigger the nearer
    double time = 0;      ///< when it was read, s
};

struct RabBoardCounters {
    unsigned long transfers = 0;  ///< that succeeded
    unsigned long retries = 0;    ///< that failed and were tried again
    unsigned long failures = 0;   ///< given up
};

enum class RabPoll { Empty, Message, Failed };

class RabBoard {
  public:
    RabBoard(I2cDevice& device, Clock& clock, RabBoardSettings settings);

    /// The set-up ARGoS makes, in its order (emission power, payload size, computing on the board, 20 ms,
    /// darkness, 20 ms, payload size), then throws away what the board still held. Takes 45 ms. False: no
    /// answer.
    bool initialise();
    /// Sets the emission power again: a board that is just booting overwrites an early setting.
    bool repeat_range();

    RabPoll poll(RabPacket& packet);
    /// The same data on all emitters: one operation, whatever the size.
    bool send_all(std::uint32_t payload);
    /// Each emitter its own data, empty ones stay dark: twelve stores at most, then one frame.
    bool send_each(const std::array<std::optional<std::uint32_t>, rab::kEmitters>& payloads);

    const RabBoardSettings& settings() const { return settings_; }
    const RabBoardCounters& counters() const { return counters_; }
    /// errno value of the last transfer given up.
    int last_error() const { return last_error_; }
    /// Operations given up since the last that succeeded.
    int failed_in_a_row() const { return failed_in_a_row_; }

  private:
    bool transfer(std::span<const I2cMessage> messages);
    bool write(std::uint8_t number, std::uint8_t value);
    bool read_singly(std::array<std::uint8_t, 12>& values);
    bool read_burst(std::array<std::uint8_t, 12>& values);

    I2cDevice& device_;
    Clock& clock_;
    RabBoardSettings settings_;
    RabBoardCounters counters_;
    int last_error_ = 0;
    int failed_in_a_row_ = 0;
};

}  // namespace puckloop::control
