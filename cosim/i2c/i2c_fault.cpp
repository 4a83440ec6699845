#include "cosim/i2c/i2c_fault.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::cosim {

namespace {

constexpr std::array<std::string_view, 13> kI2cFaultNames{"nack",
                                                          "sda",
                                                          "scl",
                                                          "stretch",
                                                          "lose_arbitration",
                                                          "flip",
                                                          "start",
                                                          "stop",
                                                          "incomplete_address_phase",
                                                          "incomplete_write_byte",
                                                          "slave_reset",
                                                          "clash",
                                                          "slow_rise"};
constexpr std::array<std::string_view, 4> kBytes{"any", "address", "write", "read"};

constexpr std::uint8_t kHighestSlaveAddress = 0x77;

template <class T>
std::optional<T> whole(const FaultSpec& spec, std::string_view key) {
    if (!spec.parameters.has(key)) return std::nullopt;
    return static_cast<T>(spec.parameters.number(key));
}

I2cWhere read_where(const FaultSpec& spec) {
    I2cWhere where;
    if (!spec.from.empty()) where.master = spec.from.substr(spec.from.rfind('.') + 1);
    where.address = whole<std::uint8_t>(spec, "address");
    where.reg = whole<std::uint8_t>(spec, "register");
    where.position = whole<std::uint32_t>(spec, "position");
    const std::string bytes = spec.parameters.text("phase", "any");
    const auto* found = std::find(kBytes.begin(), kBytes.end(), bytes);
    where.bytes = static_cast<I2cBytes>(found == kBytes.end() ? 0 : found - kBytes.begin());
    return where;
}

void check(const I2cFault& fault, const FaultSpec& spec) {
    const auto refuse = [&](const char* what, const char* expected) {
        throw InputError("", fmt::format("{} fault on {}", spec.kind, spec.link), what, expected);
    };
    const I2cWhere& where = fault.where;
    if (where.address.value_or(0) > kHighestSlaveAddress)
        refuse("a reserved address", "a 7-bit address up to 0x77");
    const bool address_byte = where.bytes == I2cBytes::Address || where.position == 0u;
    if ((fault.kind == I2cFaultKind::Start || fault.kind == I2cFaultKind::Stop) && address_byte)
        refuse("an address byte has a START before it as it is", "a byte behind it");
    if (fault.kind == I2cFaultKind::LoseArbitration && where.bytes == I2cBytes::Read)
        refuse("a master sends nothing in a read but its acknowledges", "an address byte or a write");
    if (fault.kind == I2cFaultKind::Nack && where.bytes == I2cBytes::Read)
        refuse("a byte read is acknowledged by its master", "an address byte or a write");
    if (fault.kind == I2cFaultKind::Flip && fault.bit == 0 && address_byte)
        refuse("bit 0 of an address byte is the direction", "bit 7 to 1");
}

}  // namespace

std::string_view i2c_fault_name(I2cFaultKind kind) {
    return kI2cFaultNames.at(static_cast<std::size_t>(kind));
}

std::optional<I2cFaultKind> i2c_fault_of_name(std::string_view name) {
    const auto* found = std::find(kI2cFaultNames.begin(), kI2cFaultNames.end(), name);
    if (found == kI2cFaultNames.end()) return std::nullopt;
    return static_cast<I2cFaultKind>(found - kI2cFaultNames.begin());
}

I2cFault read_i2c_fault(const FaultSpec& spec) {
    const auto kind = i2c_fault_of_name(spec.kind);
    if (!kind)
        throw InputError("", fmt::format("fault on {}", spec.link),
                         fmt::format("an I2C bus knows no fault '{}'", spec.kind));
    I2cFault fault;
    fault.kind = *kind;
    fault.where = read_where(spec);
    fault.time = spec.parameters.time("time");
    fault.bit = whole<int>(spec, "bit");
    fault.value = whole<std::uint8_t>(spec, "value").value_or(0);
    const bool line = fault.kind == I2cFaultKind::Sda || fault.kind == I2cFaultKind::Scl;
    const I2cWhere& where = fault.where;
    const bool anywhere = where.master.empty() && !where.address && !where.reg && !where.position &&
                          where.bytes == I2cBytes::Any;
    fault.timed =
        line && anywhere && spec.probability >= 1.0 && !spec.burst && spec.skip == 0 && spec.every == 1;
    check(fault, spec);
    return fault;
}

}  // namespace puckloop::cosim
