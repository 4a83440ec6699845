#pragma once
// One I2C adapter of the Linux board (/dev/i2c-N) as bus master: transfers become phases on the robot's bus,
// each taking its real time; the calling thread waits until the STOP.
//
// As in i2c-omap, the time-out of 1 s is that of one message of a transfer; I2C_TIMEOUT is about retries. When
// it runs out the call fails with ETIMEDOUT and the controller is reset, which the bus sees as a STOP.
//
// Deviations: 1. One byte is one phase: no bus clock jitter, no driver overhead between bytes.
// 2. After BusLost the transfer fails with EAGAIN at once; the driver's own retries are not modelled.
// 3. No SMBus PEC, no alert.
//
// A ten-bit address takes two bytes: 11110, two bits and "write", then the other eight; a read goes on with a
// repeated START and the first byte with "read" (UM10204, 3.1.11).

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

namespace puckloop::linuxboard {

struct I2cMessage {
    std::uint16_t address = 0;  ///< 7 bits, or 10
    bool read = false;
    bool counted = false;  ///< the first byte read gives how many follow (SMBus block read)
    std::string data;      ///< to write
    std::uint16_t length = 0;
    bool ten_bits = false;  ///< of the address
};

struct I2cTransfer {
    std::uint32_t owner = 0;
    std::vector<I2cMessage> messages;
    cosim::Time timeout = 0;  ///< for each message, START to last byte; then ETIMEDOUT
};

struct I2cResult {
    std::uint32_t owner = 0;
    int error = 0;  ///< errno value
    std::int64_t messages = 0;
    std::string data;
    cosim::Time time = 0;
};

class I2cAdapter {
  public:
    /// `clock_period` of SCL in picoseconds; `nack_error` is what the board's driver returns when a slave
    /// does not acknowledge (EREMOTEIO or ENXIO). Each transfer waits `hold` for the bus before its START:
    /// other masters, slaves that stretch the clock.
    I2cAdapter(cosim::Time clock_period, int nack_error, cosim::Time hold = 0)
        : period_(clock_period), nack_error_(nack_error), hold_(hold) {}

    void submit(I2cTransfer transfer, cosim::Time now);
    /// The owner does not wait any more; what is on the bus goes on to its STOP.
    void abandon(std::uint32_t owner);
    void deliver(const cosim::I2cPhase& phase, cosim::Time now);
    /// Begins every phase due up to and including `now`.
    void advance(cosim::Time now, std::vector<cosim::I2cPhase>& begun);
    cosim::Time next_event() const;
    /// Start of the next phase if no answer comes in before; kNever if that depends on an answer.
    cosim::Time next_phase() const { return step_ == Step::Waiting ? cosim::kNever : next_; }
    /// When a transfer may end at the earliest, if no answer comes in before.
    cosim::Time next_completion() const;
    /// Whether this answer would end a transfer at once.
    bool ends_with(const cosim::I2cPhase& answer) const {
        return step_ == Step::Waiting && (answer.kind == cosim::I2cPhaseKind::BusLost || stopping_);
    }
    std::vector<I2cResult> take_results();

    std::uint64_t transfers() const { return transfers_; }
    std::uint64_t failures() const { return failures_; }

  private:
    enum class Step { Idle, Start, SecondAddress, ReadAgain, Byte, Stop, Finish, Waiting };

    void begin_next(cosim::Time now);
    bool goes_on_addressing(const I2cMessage& message, cosim::Time now);
    void after_byte(cosim::Time now);
    void fail(int error, cosim::Time now, bool owns_bus);
    cosim::I2cPhase phase(cosim::I2cPhaseKind kind, std::uint8_t byte = 0) const;

    cosim::Time period_;
    int nack_error_;
    cosim::Time hold_;
    std::deque<I2cTransfer> queue_;
    Step step_ = Step::Idle;
    cosim::Time next_ = cosim::kNever;
    cosim::Time bus_free_ = 0;
    cosim::Time timeout_at_ = cosim::kNever;  // on the message under way
    std::size_t message_ = 0;
    std::size_t byte_ = 0;
    bool addressed_ = false;
    bool shared_ = false;    // another master sends the same (cosim/i2c/i2c_shared.h) ...
    bool stopping_ = false;  // ... and our STOP waits for it
    int address_bytes_ = 0;  // acknowledged, of a ten-bit address
    std::size_t length_ = 0;
    I2cResult result_;
    std::vector<I2cResult> results_;
    std::uint64_t transfers_ = 0;
    std::uint64_t failures_ = 0;
};

}  // namespace puckloop::linuxboard
