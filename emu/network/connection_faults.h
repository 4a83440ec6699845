#pragma once
// Faults that concern connections and addresses rather than single packets: a connection that is reset when a
// certain octet passes, and an address that another computer has too.
// Sources: RFC 9293, 3.10.7 (resets); RFC 826 (ARP); Linux, Documentation/networking/ip-sysctl.rst
// (neigh/default/base_reachable_time).
//
// Deviations: 1. What answers with a reset takes no time on the air. 2. The other computer with an address is
// where its owner is, and has nothing but that address: it answers TCP with resets and is silent
// otherwise. 3. A belief about an address ends with the fault.

#include "base/random.h"
#include "emu/network/passage.h"
#include "protocols/network/ip_packet.h"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

namespace puckloop::network {

/// Two packets that arrive together come one behind the other.
inline constexpr cosim::Time kBehind = cosim::kMicrosecond;

/// A whole TCP segment in its packet, or nothing.
std::optional<std::pair<protocols::IpPacket, protocols::TcpSegment>> segment_in(const Passage& sent);

/// A reset to the sender of `sent`, as if its receiver answered.
std::optional<Passage> reset_to_sender(const Passage& sent);

/// Connections, each with how far it has come in each direction, and whether it was reset.
class ResetConnections {
  public:
    enum class Verdict : std::uint8_t {
        Passes,
        Reaches,  ///< the first segment of its direction with the octet in it, or one behind it
        Dead,     ///< of a connection that was reset
    };
    /// To be asked for each packet. `counts`: its direction is one whose octets count.
    Verdict look(const Passage& sent, bool counts, std::uint64_t octet);
    /// The connection of `sent`, which Reaches, is reset: what is before the octet arrives, and a reset at
    /// either end.
    std::vector<Passage> reset(const Passage& sent, std::uint64_t octet);

  private:
    /// Addresses and ports, the sender's first.
    using Ends = std::tuple<protocols::IpAddress, std::uint16_t, protocols::IpAddress, std::uint16_t>;
    struct Flow {
        std::uint32_t first = 0;  ///< number of its first octet
        bool reached = false;
    };
    std::map<Ends, Flow> flows_;
    std::set<Ends> dead_;  ///< both directions of each
};

/// Whom each computer takes for the owner of an address, for a while.
class ClashedAddress {
  public:
    /// Whether the packet goes to the other computer. `share`: how likely that one is believed, for `cache`.
    bool goes_astray(const Passage& sent, double share, cosim::Time cache, RandomStream& random);

  private:
    struct Belief {
        cosim::Time until = 0;
        bool wrong = false;
    };
    std::map<std::pair<std::size_t, std::size_t>, Belief> beliefs_;  ///< of whom, about whom
};

}  // namespace puckloop::network
