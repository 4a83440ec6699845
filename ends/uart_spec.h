#pragma once
// What the user wants at the far end of a UART: `-`, `pty`, `tcp:PORT` or `script:FILE`.

#include <cstdint>
#include <string>
#include <string_view>

namespace puckloop::exec {

struct UartSpec {
    enum class Kind : std::uint8_t { Nothing, Stdio, Pty, Tcp, Script };
    Kind kind = Kind::Nothing;
    std::uint16_t port = 0;  ///< of Tcp; 0 lets the system choose
    std::string file;        ///< of Script
};

/// `option` ("--uart1") is named in the InputError thrown for anything else.
UartSpec parse_uart_spec(std::string_view option, std::string_view text);

}  // namespace puckloop::exec
