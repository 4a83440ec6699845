#pragma once
// What is to happen in a medium's node, in order of time and then of asking.

#include "cosim/core/time.h"

#include <cstdint>
#include <map>
#include <utility>

namespace puckloop::air {

template <class Event>
class Agenda {
  public:
    using Events = std::map<std::pair<cosim::Time, std::uint64_t>, Event>;

    void add(cosim::Time at, Event event) { events_.emplace(std::pair(at, next_++), std::move(event)); }
    bool empty() const { return events_.empty(); }
    cosim::Time next() const { return events_.empty() ? cosim::kNever : events_.begin()->first.first; }
    Event take() { return std::move(events_.extract(events_.begin()).mapped()); }
    const Events& events() const { return events_; }

  private:
    Events events_;
    std::uint64_t next_ = 0;
};

}  // namespace puckloop::air
