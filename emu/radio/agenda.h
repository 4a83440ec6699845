#pragma once
// What is to happen in the medium's node, in order of time and then of asking.

#include "cosim/core/time.h"

#include <cstdint>
#include <map>
#include <utility>

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

class Agenda {
  public:
    void add(const Event& event) { events_.emplace(std::pair(event.at, next_++), event); }
    bool empty() const { return events_.empty(); }
    cosim::Time next() const { return events_.empty() ? cosim::kNever : events_.begin()->first.first; }
    Event take() {
        const Event event = events_.begin()->second;
        events_.erase(events_.begin());
        return event;
    }
    const std::map<std::pair<cosim::Time, std::uint64_t>, Event>& events() const { return events_; }

  private:
    std::map<std::pair<cosim::Time, std::uint64_t>, Event> events_;
    std::uint64_t next_ = 0;
};

}  // namespace puckloop::radio
