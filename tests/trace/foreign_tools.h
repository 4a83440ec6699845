#pragma once
// What sigrok-cli and tshark read from an exported file.

#include "trace_kit.h"

namespace puckloop::tests {

/// Bytes of one UART line as sigrok's own decoder reads them.
std::vector<unsigned> sigrok_uart(const std::string& sr, const std::string& line, unsigned baud,
                                  const std::string& parity = "none");
/// How often that decoder reports annotations of a class: rx-parity-err, rx-break, rx-warnings.
std::size_t sigrok_uart_count(const std::string& sr, const std::string& line, unsigned baud,
                              const std::string& parity, const std::string& annotation);
/// As i2c_words() of the same bus.
std::vector<std::string> sigrok_i2c(const std::string& sr, const std::string& bus);
/// One row per packet, tab-separated fields.
std::vector<std::string> tshark(const std::string& pcapng, const std::string& filter,
                                const std::string& fields);

}  // namespace puckloop::tests
