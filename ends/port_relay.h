#pragma once
// Ports of this machine at which programs of its own join a run's network: each connection to 127.0.0.1:PORT
// goes on to a socket in the file system, where a program of the run listens (linuxboard/gate). What waits in
// one direction is bounded; a side that does not read holds up the other one.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::exec {

struct RelayedPort {
    std::uint16_t port = 0;
    std::string socket;  ///< path
};

/// While it lives ports are open; afterwards the sockets are removed. A thread of its own does all I/O.
class PortRelay {
  public:
    /// Opens the ports, on loopback alone. Throws InputError for one that is in use.
    explicit PortRelay(const std::vector<RelayedPort>& ports);
    ~PortRelay();
    PortRelay(const PortRelay&) = delete;
    PortRelay& operator=(const PortRelay&) = delete;

  private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace puckloop::exec
