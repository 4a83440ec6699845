// What can happen on an I2C bus. Names that Linux' i2c-gpio fault injector has too mean the same there
// (Linux, Documentation/i2c/gpio-fault-injection.rst).

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

namespace {

constexpr double kLongestOnI2c = 3600.0;  // s
// UM10204 table 10: a rise of 1000 ns at 100 kHz at most. A clock longer by more than this is no slow rise.
constexpr double kSlowestRise = 1e-3;  // s
constexpr double kHighestAddress = 0x77;
constexpr double kLongestTransfer = 65535;

std::vector<ParameterInfo> with_where(std::vector<ParameterInfo> parameters, bool needs_address = false) {
    parameters.push_back({"address", Unit::Byte, 0, kHighestAddress, {}, needs_address});
    parameters.push_back({"register", Unit::Byte, 0, 255});
    parameters.push_back({"position", Unit::Integer, 0, kLongestTransfer});
    parameters.push_back({"phase", Unit::Text, 0, 0, {}, false, "any|address|write|read"});
    return parameters;
}

ParameterInfo lasting(double most = kLongestOnI2c) {
    return {"time", Unit::Time, 1e-9, most, {}, true};
}

}  // namespace

std::vector<KindInfo> i2c_kinds() {
    const auto each = [](std::string_view name, std::vector<ParameterInfo> parameters,
                         bool needs_address = false) {
        return KindInfo{name, PlaceKind::I2c, Style::Each, FaultKind::None,
                        with_where(std::move(parameters), needs_address)};
    };
    const auto times = [](std::string_view name) {
        return KindInfo{name,
                        PlaceKind::I2c,
                        Style::Times,
                        FaultKind::None,
                        {{"address", Unit::Byte, 0, kHighestAddress, {}, true}}};
    };
    const ParameterInfo bit{"bit", Unit::Integer, 0, 7};
    return {
        each("nack", {}),
        each("sda", {lasting()}),
        each("scl", {lasting()}),
        each("stretch", {lasting()}),
        each("lose_arbitration", {lasting(), bit}),
        each("flip", {bit}),
        each("start", {}),
        each("stop", {}),
        each("slave_reset", {lasting()}),
        each("clash", {{"value", Unit::Byte, 0, 255, 0.0}}, true),
        each("slow_rise", {lasting(kSlowestRise)}),
        times("incomplete_address_phase"),
        times("incomplete_write_byte"),
    };
}

}  // namespace puckloop::cosim
