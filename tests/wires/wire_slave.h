#pragma once
// A slave as the two wires see it, clock by clock, and what a master does to them. Written from the reference
// manuals alone; knows nothing of phases.

#include "base/random.h"
#include "cosim/core/message.h"
#include "cosim/i2c/i2c_shared.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace puckloop::wires {

/// SCL goes up and down once in clock(); START and STOP come while SCL is high.
class WireSlave {
  public:
    virtual ~WireSlave() = default;
    virtual void start() = 0;
    virtual void stop() = 0;
    /// `sda`: what the master puts on the line. Returns the line.
    virtual bool clock(bool sda) = 0;
    /// What the slave puts on the line in the next clock: a master cannot make a START or STOP against a low.
    virtual bool lets_go() const = 0;
};

/// Seeds of a drawn comparison: as many as the suite's time allows, or PUCKLOOP_WIRE_SEEDS.
inline int seeds(int usual) {
    const char* const asked = std::getenv("PUCKLOOP_WIRE_SEEDS");
    return asked == nullptr ? usual : std::max(1, std::atoi(asked));
}

struct Byte {
    std::uint8_t line = 0xFF;  ///< the line in eight clocks
    bool low = false;          ///< in the ninth
};

/// Nine clocks.
inline Byte nine_clocks(WireSlave& slave, std::uint8_t drives, bool drives_ninth_low) {
    Byte byte;
    byte.line = 0;
    for (int bit = 7; bit >= 0; --bit)
        byte.line = static_cast<std::uint8_t>(byte.line << 1 | (slave.clock(drives >> bit & 1) ? 1 : 0));
    byte.low = !slave.clock(!drives_ninth_low);
    return byte;
}

/// What the next thing is that a drawn master does, without regard to what it agreed with its address byte.
struct Action {
    enum class Kind : std::uint8_t { Start, Write, Read, Stop } kind = Kind::Stop;
    std::uint8_t byte = 0;  ///< of Start and Write
    bool ack = false;       ///< of Read
    int clocks = 9;         ///< fewer: a START or STOP breaks the byte off after so many
    bool broken_by_stop = false;
};

/// What a chip's pins see of it from `start` on, at a period of `period`.
inline cosim::I2cPhase phase_of(const Action& action, cosim::Time start, cosim::Time period) {
    using Kind = cosim::I2cPhaseKind;
    cosim::I2cPhase phase;
    phase.kind = action.kind == Action::Kind::Start   ? Kind::Start
                 : action.kind == Action::Kind::Write ? Kind::Write
                 : action.kind == Action::Kind::Read  ? Kind::Read
                                                      : Kind::Stop;
    phase.byte = action.kind == Action::Kind::Read ? std::uint8_t{0} : action.byte;
    phase.ack = action.ack;
    phase.start = start;
    phase.clock_period = period;
    return phase;
}

/// What follows is no byte, but a STOP or START that meets the first bit of what the slave is to send.
inline cosim::I2cPhase first_bit_from(cosim::Time start, cosim::Time period) {
    cosim::I2cPhase phase;
    phase.kind = cosim::I2cPhaseKind::Acknowledge;
    phase.ack = cosim::kNoByteFollows;
    phase.start = start;
    phase.clock_period = period;
    return phase;
}

class Draw {
  public:
    Draw(std::uint64_t seed, std::vector<std::uint8_t> addresses)
        : random_(seed, "wires"), addresses_(std::move(addresses)) {}

    bool one_in(std::uint64_t n) { return random_.below(n) == 0; }
    std::uint64_t below(std::uint64_t n) { return random_.below(n); }
    std::uint8_t byte() { return static_cast<std::uint8_t>(random_.below(256)); }

    /// `begun`: a START came and no STOP.
    Action action(bool begun) {
        Action action;
        const auto die = random_.below(16);
        if (!begun || die < 4) {
            action.kind = Action::Kind::Start;
        } else {
            action.kind = die < 9 ? Action::Kind::Write : die < 14 ? Action::Kind::Read : Action::Kind::Stop;
        }
        action.byte = byte();
        // What is written to one that sends is mostly ones, as from a master that is about to lose.
        if (one_in(4)) action.byte = 0xFF;
        if (action.kind == Action::Kind::Start && !one_in(8)) {
            const auto address = addresses_[random_.below(addresses_.size())];
            action.byte = static_cast<std::uint8_t>((address & 0xFE) | random_.below(2));
        }
        action.ack = one_in(2);
        if (action.kind != Action::Kind::Stop && one_in(12)) {
            action.clocks = 1 + static_cast<int>(random_.below(7));
            action.broken_by_stop = one_in(2);
        }
        return action;
    }

  private:
    RandomStream random_;
    std::vector<std::uint8_t> addresses_;
};

/// The registers that a service routine finds, and what it decides: both sides draw the same.
class Policy {
  public:
    std::uint16_t next() {
        state_ = static_cast<std::uint16_t>(state_ * kFactor + kSum);
        return state_;
    }
    static constexpr std::uint32_t kFactor = 25173, kSum = 13849;

  private:
    std::uint16_t state_ = 1;
};

}  // namespace puckloop::wires
