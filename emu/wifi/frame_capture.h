#pragma once
// The frames of a wireless network as a monitor would capture them: pcapng with radiotap headers, written
// frame by frame as they begin, so that a run of any length needs no memory for it.
//
// Deviations: 1. The monitor hears every frame, with the power at the station that is to read it (of one to
// all: at the nearest). 2. MAC addresses are made from IPv4 addresses, 02:00 and the four octets; the access
// point is 02:00:00:00:00:01. 3. Sequence numbers count packets of the network, not of a station. 4. No
// beacons.

#include "emu/wifi/medium.h"
#include "protocols/network/ieee80211.h"
#include "protocols/network/pcapng.h"

#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace puckloop::wifi {

class FrameCapture {
  public:
    /// `macs`: of the stations. `access_point`: the station that is one; kEveryStation: none. Throws RunError
    /// if the file cannot be written.
    FrameCapture(const std::string& file, const WifiSettings& settings,
                 std::vector<protocols::MacAddress> macs, std::size_t access_point);

    /// A frame that begins; `frame` is null for an acknowledgement. `source`: MAC address of the computer
    /// that it is from, `destination` of where it goes in the end.
    void add(const Transmission& sent, const Frame* frame, const protocols::MacAddress& source,
             const protocols::MacAddress& destination);
    void flush() { out_.flush(); }

  private:
    protocols::RadioReport report_of(const Transmission& sent) const;

    std::ofstream out_;
    pcapng::Writer writer_;
    std::uint32_t interface_;
    std::vector<protocols::MacAddress> macs_;
    std::size_t access_point_;
    bool short_preamble_;
};

}  // namespace puckloop::wifi
