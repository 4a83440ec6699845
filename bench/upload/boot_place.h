#pragma once
// Where within a packet the boot loader is.
//
// It takes any 101 octets for a packet, so what it got too much of (a second hello that was under way when it
// answered the first) shifts all that follows, and a row that is sent again after a wrong one is then taken,
// shifted: its sum is right. So whenever the place is not known it is found out: octets are sent of which no
// 101 in a row have a right sum, and by whether the loader answers one knows how many it had.

#include "bench/upload/boot_packets.h"

#include <cstddef>
#include <deque>
#include <span>

namespace puckloop::tools {

class BootPlace {
  public:
    static constexpr std::size_t kPacket = 101;  ///< octets: address, count, 32 words, check

    /// Notes what is sent: a hello, a row. Those of probe() are noted already.
    void sent(std::span<const std::uint8_t> octets);
    /// The loader has taken between 0 and `most` (100) of the octets sent last as the begin of a packet.
    void lost(std::size_t most);
    bool known() const { return low_ == high_; }
    /// A packet begins with the next octet.
    bool aligned() const { return known() && low_ == 0; }

    /// What to send to know more; once known(), what completes the packet, which is answered for certain.
    BootPacket probe();
    /// Whether the loader answered the last probe, by kBootWrong.
    void answered(bool yes);

  private:
    std::size_t middle() const;
    std::uint8_t filling() const;

    std::deque<std::uint8_t> recent_;  ///< the last 100
    std::size_t low_ = 0, high_ = 0;   ///< octets of a packet that the loader has
    bool fresh_ = false;               ///< nothing is known yet: most likely it has none
    std::size_t asked_ = 0;            ///< whether it had so many
};

}  // namespace puckloop::tools
