#pragma once
// The wire of a CAN bus and the stations on it, event by event: it is dominant where anybody drives it so.
// Nothing happens while the bus is idle. Signals take no time along the wire (deviation: the propagation
// segment has nothing to make up for).

#include "cosim/can/can_faults.h"
#include "cosim/can/can_station.h"
#include "cosim/core/time.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace puckloop::cosim {

class CanWire {
  public:
    /// Reported before it counts, which is at `time`.
    using TakeNews = std::function<void(std::size_t station, const CanNews& news, Time time)>;
    /// The wire becomes dominant after it was recessive for so long.
    using TakeEdge = std::function<void(Time now, Time quiet)>;

    CanWire(std::size_t stations, CanFaults faults, TakeNews news, TakeEdge edge);

    CanStation& station(std::size_t index) { return seats_[index].station; }
    const CanStation& station(std::size_t index) const { return seats_[index].station; }
    std::size_t size() const { return seats_.size(); }
    /// Everything that happens strictly before `until`. What is done to a station from outside comes between.
    void run_until(Time until);
    /// How a controller takes part from now on, or as soon as it drives nothing for others any more.
    struct Setup {
        bool on = false;
        CanTiming timing{};
        bool listens = false;
        unsigned tec = 0, rec = 0;
    };
    void set(std::size_t index, const Setup& setup, Time now);
    /// It is on its way to another setup: what it has to say interests nobody.
    bool leaving(std::size_t index) const { return seats_[index].next.has_value(); }

    /// No news of this station before this, unless something comes in: kErrorBits bits before at least.
    Time earliest_news(std::size_t index, Time now) const;
    /// The wire does not fall before this, unless something comes in.
    Time earliest_edge(Time now) const;
    CanFaults& faults() { return faults_; }
    const CanFaults& faults() const { return faults_; }

  private:
    struct Seat {
        CanStation station;
        std::optional<Setup> next{};
        bool seen = protocols::kRecessive;  ///< the wire's level, as the station has it
        int flip_at = -1;                   ///< of the frame's bits: this station reads it inverted
    };
    Time next_event() const;
    bool stirs() const;
    void take_seat(std::size_t index, Time now);
    void step(Time now);
    void settle(Time now);
    void sample(std::size_t index, Time now);
    void feel(std::size_t index, Time now);
    bool level_of(std::size_t index, Time now) const;

    std::vector<Seat> seats_;
    CanFaults faults_;
    TakeNews news_;
    TakeEdge edge_;
    bool level_ = protocols::kRecessive;
    Time changed_ = 0;  ///< the level
    Time fault_due_;    ///< the next change by a fault
};

}  // namespace puckloop::cosim
