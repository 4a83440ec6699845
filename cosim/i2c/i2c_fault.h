#pragma once
// A fault on an I2C bus, as its parameters (cosim/faults/kinds/i2c_kinds.cpp) ask for it: what, and on which
// bytes.

#include "cosim/core/time.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::cosim {

enum class I2cFaultKind : std::uint8_t {
    Nack,                    ///< nobody takes the byte, nobody acknowledges
    Sda,                     ///< SDA is low for `time`
    Scl,                     ///< SCL is low for `time`
    Stretch,                 ///< SCL is held low for `time` behind the byte's eighth clock
    LoseArbitration,         ///< another master pulls SDA low at `bit`, and sends a STOP `time` later
    Flip,                    ///< one bit of the byte is inverted on the way
    Start,                   ///< a START before the byte: devices take the byte for an address
    Stop,                    ///< a STOP before the byte: no device is addressed any more
    IncompleteAddressPhase,  ///< a read of `address` that ends before the acknowledge's clock
    IncompleteWriteByte,     ///< a write of 0x00 to `address` that ends before the byte's acknowledge
    SlaveReset,              ///< the addressed device begins anew, deaf for `time`
    Clash,                   ///< a second device with the same address answers, and sends `value`
    SlowRise,                ///< the lines rise so slowly that each clock takes `time` longer
};

/// "nack", "sda", ...
std::string_view i2c_fault_name(I2cFaultKind kind);
std::optional<I2cFaultKind> i2c_fault_of_name(std::string_view name);
constexpr bool is_incomplete(I2cFaultKind kind) {
    return kind == I2cFaultKind::IncompleteAddressPhase || kind == I2cFaultKind::IncompleteWriteByte;
}

enum class I2cBytes : std::uint8_t { Any, Address, Write, Read };

/// Which bytes a fault is meant for; what is not given is any.
struct I2cWhere {
    std::string master{};                   ///< port name of the master that sends or clocks the byte
    std::optional<std::uint8_t> address{};  ///< 7 bits
    /// The register that the transfer is about: the last first byte of a write to the same address.
    std::optional<std::uint8_t> reg{};
    I2cBytes bytes = I2cBytes::Any;
    std::optional<std::uint32_t> position{};  ///< from the (repeated) START: 0 the address byte, 1 the next
};

struct I2cFault {
    I2cFaultKind kind = I2cFaultKind::Nack;
    I2cWhere where{};
    /// Sda and Scl that name no bytes: the line is low from the fault's begin on, transfer or not.
    bool timed = false;
    Time time = 0;             ///< see the kinds
    std::optional<int> bit{};  ///< 7 the first on the wire .. 0; without: drawn for each byte
    std::uint8_t value = 0;    ///< Clash: what the second device sends
};

/// Throws InputError for what the bytes of a bus cannot suffer.
I2cFault read_i2c_fault(const FaultSpec& spec);

}  // namespace puckloop::cosim
