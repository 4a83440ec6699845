#pragma once
// A CAN wire with stations that have frames to send at given times, and what they get.

#include "cosim/can/can_wire.h"
#include "cosim/faults/kinds/kind_table.h"
#include "tests/can/can_reference.h"

#include <algorithm>
#include <deque>
#include <string>
#include <vector>

namespace puckloop::tests {

using cosim::CanNews;
using cosim::CanTiming;
using cosim::CanWire;
using cosim::Time;
using protocols::CanFrame;

inline constexpr Time kBit = cosim::kMicrosecond;
inline constexpr CanTiming kTiming{kBit, kBit * 3 / 4, kBit / 8};

struct Told {
    std::size_t station = 0;
    CanNews news;
    Time time = 0;
    unsigned tec = 0, rec = 0;
};

inline cosim::CarriedFault fault_of(cosim::FaultSpec spec, std::size_t index = 0) {
    const cosim::KindInfo* kind = cosim::find_kind(spec.kind, cosim::PlaceKind::Can);
    cosim::complete(spec, *kind);
    cosim::check_fault(spec, *kind);
    spec.name = "fault" + std::to_string(index);
    return {spec, cosim::Trigger(spec, cosim::fault_stream(spec, 7, index))};
}

class WireBench {
  public:
    struct Wish {
        Time time = 0;
        CanFrame frame;
    };
    explicit WireBench(std::size_t stations, std::vector<cosim::FaultSpec> faults = {})
        : wishes(stations),
          wire(
              stations, carried(faults, stations),
              [this](std::size_t index, const CanNews& news, Time now) { take(index, news, now); },
              [](Time, Time) {}) {}

    void join_all(const CanTiming& timing = kTiming) {
        for (std::size_t i = 0; i < wire.size(); ++i)
            wire.set(i, {true, timing}, 0);
    }
    /// One frame after the other, each not before its time and the end of the one before.
    void run(Time until) {
        while (now < until) {
            for (std::size_t i = 0; i < wishes.size(); ++i)
                if (!busy(i) && !wishes[i].empty() && wishes[i].front().time <= now) offer(i, now);
            Time next = std::min(until, now + 10 * kBit);
            for (std::size_t i = 0; i < wishes.size(); ++i)
                if (!wishes[i].empty() && wishes[i].front().time > now)
                    next = std::min(next, wishes[i].front().time);
            wire.run_until(next);
            now = next;
        }
    }
    std::vector<Told> of(std::size_t station, CanNews::What what) const {
        std::vector<Told> some;
        std::copy_if(told.begin(), told.end(), std::back_inserter(some),
                     [&](const Told& one) { return one.station == station && one.news.what == what; });
        return some;
    }

    std::vector<std::deque<Wish>> wishes;
    std::vector<Told> told;
    CanWire wire;
    Time now = 0;

  private:
    static cosim::CanFaults carried(const std::vector<cosim::FaultSpec>& faults, std::size_t stations) {
        std::vector<cosim::CarriedFault> list;
        for (std::size_t i = 0; i < faults.size(); ++i)
            list.push_back(fault_of(faults[i], i));
        std::vector<std::string> names;
        for (std::size_t i = 0; i < stations; ++i)
            names.push_back("s" + std::to_string(i));
        return {std::move(list), std::move(names)};
    }
    bool busy(std::size_t i) const { return wire.station(i).wants_to_send() || wire.station(i).bus_off(); }
    void offer(std::size_t i, Time when) {
        const CanFrame frame = wishes[i].front().frame;
        wishes[i].pop_front();
        wire.station(i).offer({frame, protocols::can_levels(frame), 0}, when);
    }
    void take(std::size_t index, const CanNews& news, Time when) {
        told.push_back(
            {index, news, when, wire.station(index).transmit_errors(), wire.station(index).receive_errors()});
        if (news.what == CanNews::What::Sent && !wishes[index].empty() && wishes[index].front().time <= when)
            offer(index, when);
    }
};

}  // namespace puckloop::tests
