#pragma once
// What a bus sends to masters that made the same START with the same address byte within half a clock: both
// have the bus, and each bit decides whether they still agree (UM10204, 3.1.8).

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

/// `ack` of a Write whose first bit, a 0, was the ninth clock of the byte before it: `byte` is what the
/// devices see from there on, seven bits and a 1, which is the master's own ninth clock. Acknowledged if that
/// is low; by devices that are to receive in the clock after it.
inline constexpr std::uint8_t kBehindNinthClock = 2;

}  // namespace puckloop::cosim
