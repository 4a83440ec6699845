// What can happen to a Linux program: in its calls on the serial port and the I2C adapter, and to its
// process. Error numbers of the I2C adapter: Linux, Documentation/i2c/fault-codes.rst. How long a name is
// asked for: glibc's resolver, resolv.conf(5), options timeout and attempts.

#include "cosim/faults/kinds/kind_table.h"

namespace puckloop::cosim {

namespace {
constexpr double kLongestOfCall = 3600.0;  // s
constexpr double kMostBytes = 4096;
constexpr double kMostStarving = 1e6;
constexpr double kResolverTimeout = 5.0, kResolverAttempts = 2, kMostAttempts = 10;
constexpr std::string_view kTtyErrors = "EAGAIN|EINTR|EIO|ENXIO|ENODEV|ENOMEM";
constexpr std::string_view kI2cErrors =
    "EIO|EAGAIN|EBUSY|EINVAL|ENODEV|ENOMEM|ENXIO|EOPNOTSUPP|EPROTO|EREMOTEIO|ETIMEDOUT";
}  // namespace

std::vector<KindInfo> linux_kinds() {
    const auto kind = [](std::string_view name, Style style, std::vector<ParameterInfo> parameters) {
        return KindInfo{name, PlaceKind::Linux, style, FaultKind::None, std::move(parameters)};
    };
    const auto text = [](std::string_view key, std::string_view choices) {
        return ParameterInfo{key, Unit::Text, 0, 0, {}, false, choices};
    };
    const ParameterInfo most{"most", Unit::Integer, 1, kMostBytes, 1.0};
    return {
        kind("read_error", Style::Each, {text("errno", kTtyErrors)}),
        kind("write_error", Style::Each, {text("errno", kTtyErrors)}),
        kind("short_read", Style::Each, {most}),
        kind("short_write", Style::Each, {most}),
        kind("termios_refused", Style::Each,
             {text("setting", "baud|data_bits|parity|stop_bits|mode|timing")}),
        kind("termios_baud", Style::Each, {{"baud", Unit::Number, 50, 4e6, {}, true}}),
        kind("i2c_error", Style::Each, {text("errno", kI2cErrors), {"address", Unit::Byte, 0, 0x77}}),
        kind("hang_up", Style::Times, {}),
        kind("pause", Style::Times, {{"time", Unit::Time, 1e-6, kLongestOfCall, {}, true}}),
        kind("starve", Style::Hold, {{"factor", Unit::Number, 1.0, kMostStarving, {}, true}}),
        kind("kill", Style::Times, {text("run", "ends|goes_on")}),
        kind("restart", Style::Times, {{"down", Unit::Time, 0.0, kLongestOfCall, 0.0}}),
        kind("dns_silence", Style::Hold,
             {{"timeout", Unit::Time, 0.001, kLongestOfCall, kResolverTimeout},
              {"attempts", Unit::Integer, 1, kMostAttempts, kResolverAttempts}}),
    };
}

}  // namespace puckloop::cosim
