#pragma once
// Ports of 127.0.0.1, without what serves them: `run --view` looks whether one is free before it begins.

#include <cstdint>
#include <string_view>

namespace puckloop::view {

/// A socket that listens; `port` 0: at any that is free. Throws InputError, naming `option`, if it is taken.
int listen_at(std::uint16_t port, std::string_view option);

/// Throws as that does, and keeps nothing.
void check_port(std::uint16_t port, std::string_view option);

}  // namespace puckloop::view
