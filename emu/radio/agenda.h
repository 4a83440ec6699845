#pragma once
// What is to happen in the medium's node, in order of time and then of asking.

#include "emu/air/agenda.h"

#include <cstdint>

namespace puckloop::radio {

enum class EventKind : std::uint8_t {
    // MAC
    Access,      ///< a station's backoff is over
    NoAccess,    ///< a station gives an attempt up, as the channel was never free
    FrameEnd,    ///< a transmission ends
    AckEnd,      ///< an acknowledgement ends
    AckMissing,  ///< a station has waited for one long enough
    // Network
    Submit,        ///< a station hands a frame to its MAC
    Repeat,        ///< a station sends a broadcast again
    Dropped,       ///< a station's frame was forgotten when its module changed channel, PAN or address
    RouteMissing,  ///< nobody answered a route request
    NetworkAckMissing,
};

struct Event {
    cosim::Time at = 0;
    EventKind kind = EventKind::Access;
    std::size_t station = 0;
    std::uint64_t token = 0;  ///< which transmission, job, packet
};

class Agenda : public air::Agenda<Event> {
  public:
    void add(const Event& event) { air::Agenda<Event>::add(event.at, event); }
};

}  // namespace puckloop::radio
