#include "ends/uart_spec.h"

#include "base/error.h"
#include "ends/text_input.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::exec {

UartSpec parse_uart_spec(std::string_view option, std::string_view text) {
    constexpr std::string_view kTcp = "tcp:", kScript = "script:";
    if (text == "-") return {UartSpec::Kind::Stdio, 0, {}};
    if (text == "pty") return {UartSpec::Kind::Pty, 0, {}};
    if (text.starts_with(kTcp)) {
        const std::string_view digits = text.substr(kTcp.size());
        std::uint16_t port = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
        if (digits.empty() || error != std::errc{} || end != digits.data() + digits.size())
            throw InputError("", std::string(option), fmt::format("'{}' has no TCP port", text),
                             "tcp:PORT, 0 to 65535");
        return {UartSpec::Kind::Tcp, port, {}};
    }
    if (text.starts_with(kScript) && text.size() > kScript.size())
        return {UartSpec::Kind::Script, 0, std::string(text.substr(kScript.size()))};
    throw InputError("", std::string(option), fmt::format("'{}' is not an end for a UART", text),
                     "-, pty, tcp:PORT or script:FILE");
}

}  // namespace puckloop::exec
