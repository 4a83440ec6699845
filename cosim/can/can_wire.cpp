#include "cosim/can/can_wire.h"

#include <algorithm>

namespace puckloop::cosim {

using protocols::kDominant;
using protocols::kRecessive;

CanWire::CanWire(std::size_t stations, CanFaults faults, TakeNews news, TakeEdge edge)
    : seats_(stations),
      faults_(std::move(faults)),
      news_(std::move(news)),
      edge_(std::move(edge)),
      fault_due_(faults_.held_dominant(0) ? 0 : faults_.next_change(0)) {}

Time CanWire::next_event() const {
    Time next = fault_due_;
    for (const Seat& seat : seats_)
        next = std::min(next, seat.station.next_event());
    return next;
}

void CanWire::run_until(Time until) {
    for (Time next = next_event(); next < until; next = next_event())
        step(next);
}

void CanWire::set(std::size_t index, const Setup& setup, Time now) {
    Seat& seat = seats_[index];
    seat.next = setup;
    if (seat.station.may_leave()) take_seat(index, now);
}

void CanWire::take_seat(std::size_t index, Time now) {
    Seat& seat = seats_[index];
    const Setup setup = *seat.next;
    seat.next.reset();
    seat.flip_at = -1;
    seat.station.leave();
    seat.seen = level_of(index, now);
    const Time quiet_since = level_ == kRecessive ? changed_ : now;
    if (setup.on) seat.station.join(setup.timing, setup.listens, now, quiet_since, setup.tec, setup.rec);
}

/// The wire at this station.
bool CanWire::level_of(std::size_t index, Time now) const {
    if (!faults_.empty() && faults_.cut_off(index, now))
        return seats_[index].station.drives_low() ? kDominant : kRecessive;
    return level_;
}

/// All bits that begin now, then what that makes of the wire, then all samples.
void CanWire::step(Time now) {
    if (fault_due_ <= now) fault_due_ = faults_.next_change(now);
    for (std::size_t i = 0; i < seats_.size(); ++i) {
        CanStation& station = seats_[i].station;
        if (station.samples_next() || station.next_event() != now) continue;
        station.begin_bit(now);
        if (seats_[i].next && station.may_leave()) take_seat(i, now);
    }
    settle(now);
    for (std::size_t i = 0; i < seats_.size(); ++i) {
        CanStation& station = seats_[i].station;
        if (station.samples_next() && station.next_event() == now) sample(i, now);
    }
}

void CanWire::settle(Time now) {
    bool level = kRecessive;
    for (std::size_t i = 0; i < seats_.size(); ++i)
        if (seats_[i].station.drives_low() && (faults_.empty() || !faults_.cut_off(i, now)))
            level = kDominant;
    if (!faults_.empty() && faults_.held_dominant(now)) level = kDominant;
    if (level != level_) {
        level_ = level;
        if (level == kDominant) edge_(now, now - changed_);
        changed_ = now;
    }
    for (std::size_t i = 0; i < seats_.size(); ++i) {
        Seat& seat = seats_[i];
        const bool seen = level_of(i, now);
        if (seen == seat.seen) continue;
        seat.seen = seen;
        if (seen == kDominant) seat.station.fall(now);
    }
}

void CanWire::sample(std::size_t index, Time now) {
    Seat& seat = seats_[index];
    bool level = seat.seen;
    if (!faults_.empty()) feel(index, now);
    if (seat.flip_at >= 0 && seat.station.frame_bit() >= seat.flip_at) {
        if (seat.station.frame_bit() == seat.flip_at) level = !level;
        seat.flip_at = -1;
    }
    if (const std::optional<CanNews> news = seat.station.sample(level))
        news_(index, *news, seat.station.next_bit());
    if (!seat.station.take_won()) return;
    const CanOffer& sending = seat.station.sending();
    for (const CanFlip& flip : faults_.strike(index, sending.frame, sending.bits, seat.station.frame_start()))
        for (std::size_t i = 0; i < seats_.size(); ++i)
            if (!flip.who || *flip.who == i) seats_[i].flip_at = flip.bit;
}

/// Evidence of what holds for a while.
void CanWire::feel(std::size_t index, Time now) {
    const CanStation& station = seats_[index].station;
    if (faults_.cut_off(index, now)) {
        if (seats_[index].seen != level_ || station.drives_low()) faults_.felt_cut(now, index);
    } else if (faults_.held_dominant(now)) {
        faults_.felt_dominant(now, index);
    }
}

bool CanWire::stirs() const {
    return level_ == kDominant || std::any_of(seats_.begin(), seats_.end(), [](const Seat& seat) {
               return seat.station.busy() || seat.station.wants_to_send();
           });
}

Time CanWire::earliest_edge(Time now) const {
    return stirs() ? now : std::max(now, fault_due_);
}

Time CanWire::earliest_news(std::size_t index, Time now) const {
    const CanStation& station = seats_[index].station;
    const Time by_fault = later(std::max(now, fault_due_), CanStation::kErrorBits * station.timing().bit);
    return std::min(station.earliest_news(now, stirs()), station.on() ? by_fault : kNever);
}

}  // namespace puckloop::cosim
