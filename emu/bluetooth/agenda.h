#pragma once
// What is to happen in the Bluetooth node, in order of time and then of asking.

#include "emu/air/agenda.h"

#include <cstdint>
#include <vector>

namespace puckloop::bluetooth {

enum class EventKind : std::uint8_t {
    // Of the air (network.h).
    Found,        ///< `other` answers the inquiry `token` of `station`
    InquiryOver,  ///< `token`
    Named,        ///< the name request `token` of `station` is through
    NameMissing,  ///< ... finds nobody
    Linked,       ///< the connection attempt `token` of `station` is through
    NotLinked,    ///< ... finds nobody
    Deliver,      ///< `bytes` of `station` arrive at the other end of the link `token`
    Released,     ///< the link `token` is taken down, as `station` wished
    Lost,         ///< nobody was heard on the link `token` since the outage `turn` began
    // Of a station.
    Boot,        ///< a module is ready
    Request,     ///< a module has understood the packet `bytes`
    Flush,       ///< what came in transparently goes on the air
    Left,        ///< the host has ended transparent mode
    SpeedTaken,  ///< the serial line's new settings are in force
    Dial,        ///< a computer, or a module with stored connections, links
};

struct Event {
    EventKind kind = EventKind::Boot;
    std::size_t station = 0;
    std::size_t other = 0;
    std::uint64_t token = 0;  ///< which inquiry, request, link
    std::uint64_t turn = 0;
    std::vector<std::uint8_t> bytes{};
};

using Agenda = air::Agenda<Event>;

}  // namespace puckloop::bluetooth
