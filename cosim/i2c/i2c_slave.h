#pragma once
// What a bus asks of a device on it.
//
// A device may live in the bus's own node and answer at once (a register map, say), or be a node of its own
// (a board with a microcontroller), which the bus speaks to through a port: see I2cBusNode.

#include "cosim/core/message.h"
#include "cosim/core/node.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace puckloop::cosim {

/// How a device ends a byte: acknowledge of an address or a byte written, or the byte read; and how much
/// longer than the master's ninth clock it held SCL low.
struct I2cAnswer {
    bool acknowledge = false;
    std::uint8_t byte = 0xFF;
    Time stretch = 0;
};

class I2cSlave {
  public:
    /// Hands out a signal: id on the bus node's `world` port, value in the signal's unit.
    using Emit = std::function<void(std::uint16_t id, double value)>;

    virtual ~I2cSlave() = default;
    virtual std::string_view name() const = 0;
    /// Does it listen to this 7-bit address?
    virtual bool listens_to(std::uint8_t address) const = 0;

    /// START with its address: acknowledge or not.
    virtual I2cAnswer start(bool read, Time now) = 0;
    /// A byte for the addressed device.
    virtual I2cAnswer write(std::uint8_t byte, Time now) = 0;
    /// The next byte from the addressed device.
    virtual I2cAnswer read(Time now) = 0;
    /// STOP, or a repeated START for somebody else.
    virtual void stop(Time /*now*/, const Emit& /*emit*/) {}
    /// It begins anew, as when its supply comes back.
    virtual void reset(const Emit& /*emit*/) {}
    /// A signal came in by the bus node's `world` port.
    virtual void signal(std::uint16_t /*id*/, double /*value*/) {}
    /// The same for a device to which it matters when.
    virtual void signal_at(std::uint16_t id, double value, Time /*now*/) { signal(id, value); }
    /// As Node::rewindable(): with a device that cannot go back the bus cannot.
    virtual Rewindable* rewindable() { return nullptr; }
    /// The device's part of the bus's report, as JSON text.
    virtual std::string report() const { return "{}"; }
};

}  // namespace puckloop::cosim
