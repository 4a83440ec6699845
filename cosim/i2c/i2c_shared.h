#pragma once
// What masters and bus hand each other beside whole bytes: of masters that made the same START with the same
// address byte within half a clock (both have the bus, and each bit decides whether they still agree,
// UM10204, 3.1.8), and of one whose clocks are not those of whole bytes.

#include "cosim/core/message.h"

#include <cstdint>

namespace puckloop::cosim {

/// A phase of this kind that comes to a master before the answer to its address byte. From then on, until
/// its STOP or BusLost, the master's STOPs are answered too (Acknowledge when it is made).
inline constexpr I2cPhaseKind kSharedNotice = I2cPhaseKind::Read;

/// `ack` of a Read of such a master that decides after the byte (the dsPIC by ACKEN): it sends an Acknowledge
/// with its decision, which is answered: Acknowledge with the line in the ninth clock, or BusLost.
inline constexpr std::uint8_t kAcknowledgedLater = 2;

/// `ack` of the Data of a byte read from devices that are to receive, one of which acknowledges it: it holds
/// SDA low in the ninth clock, until SCL has gone up and down. A master that finds it so lets both lines go
/// and sends a BusLost.
inline constexpr std::uint8_t kDeviceAcknowledges = 3;

/// `ack` of a Write to devices that send, whose first bit, a 0, was the ninth clock of the byte before it:
/// `byte` is what the devices see from there on, seven bits and a 1, which is the master's own ninth clock.
/// Acknowledged if that is low. The ninth clock of the devices' byte is still to come.
inline constexpr std::uint8_t kBehindNinthClock = 2;

/// `ack` of an Acknowledge of a master that is alone, and of the same at a device: the byte before, or the
/// address, was acknowledged, but no byte follows. What the devices send next is on SDA in the clock that
/// comes, as soon as they let SCL go: answered with Acknowledge, `ack` = 1 where they hold SDA low. The bus
/// answers its master with BusLost then, for neither STOP nor START can be made (UM10204, 3.1.4).
inline constexpr std::uint8_t kNoByteFollows = 1;

/// A Data phase of a master: clocks that are out of step with the bytes of devices that are to receive,
/// because ninth clocks were left out or are too many. `byte` is what the master puts on SDA, from its
/// highest bit on; in a ninth clock SDA is let go.
struct LooseClocks {
    int before = 0;  ///< clocks that the devices' byte has had, 0 to 8
    int count =
        0;  ///< 1: an acknowledge; 8: a byte received, whose 1s are no bits of the master's; 9: a byte sent

    constexpr std::uint8_t packed() const { return static_cast<std::uint8_t>(before << 4 | count); }
    static LooseClocks of(std::uint8_t ack) { return {ack >> 4, ack & 0xF}; }
    int after() const { return (before + count) % kClocks; }
    bool valid() const { return before < kClocks && (count == 1 || count == 8 || count == kClocks); }
    bool drives() const { return count != 8; }
    /// The bus answers when nine clocks are over, with Data: `byte` is the line in the first eight clocks,
    /// `ack` has kLineLow and kHeldLow. Or with BusLost, where a 1 of the master's finds SDA low. A single
    /// clock that is neither the eighth nor the ninth of a device's byte ends by itself.
    bool answered() const { return count > 1 || before >= kClocks - 2; }

    static constexpr int kClocks = 9;
    static constexpr std::uint8_t kLineLow = 1;  ///< in the ninth clock
    static constexpr std::uint8_t kHeldLow = 2;  ///< a device acknowledges in the clock that comes
};

/// The answer to what a master asks beside whole bytes, where nobody is in its way.
inline I2cPhase free_line(const I2cPhase& asked) {
    I2cPhase line = asked;
    line.ack = 0;
    return line;
}

static_assert(LooseClocks{8, LooseClocks::kClocks}.packed() == kMostI2cAck);

}  // namespace puckloop::cosim
