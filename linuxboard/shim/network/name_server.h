#pragma once
// The resolver that each board has at 127.0.0.53, as systemd-resolved is one: programs that ask a name server
// by themselves (dig, c-ares, musl) find it in /etc/resolv.conf. It knows the computers of the network.

#include "linuxboard/shim/network/network_spec.h"
#include "linuxboard/shim/wire/interfaces.h"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop::linuxboard {

inline constexpr protocols::IpAddress kResolver = wire::kResolver;

class NameServer {
  public:
    explicit NameServer(const NetworkSpec& spec);

    struct Answer {
        std::string datagram;
        std::string name;      ///< that was asked for
        bool unknown = false;  ///< nobody has it
    };
    /// Nothing for what is no question.
    std::optional<Answer> answer(std::string_view datagram) const;

  private:
    std::map<std::string, protocols::IpAddress> addresses_;  ///< names in small letters
    std::map<protocols::IpAddress, std::string> names_;
};

}  // namespace puckloop::linuxboard
