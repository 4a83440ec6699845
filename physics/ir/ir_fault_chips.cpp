// Chips that are inverted, and edges that come late.

#include "physics/ir/ir_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::physics {

using cosim::CarriedFault;
using cosim::kNever;
using cosim::Time;

namespace {

// No frame is dark for more than two chips; a third one only decides that it is over.
constexpr Time kDarkChips = 2, kEndChips = 3;

}  // namespace

std::uint16_t IrFaults::lit(std::size_t sender, std::size_t receiver, std::uint16_t mask) const {
    const Seen& seen = seen_[path(sender, receiver)];
    const std::uint16_t lit = seen.late > 0 ? seen.mask : mask;
    if (!seen.flipped) return lit;
    return lit != 0 ? std::uint16_t{0} : tracks_[sender].mask;
}

/// Which chip is under way follows from the time since the newest edge.
void IrFaults::follow(Time now, std::size_t sender, std::uint16_t mask, bool begins) {
    spread(now, sender, mask);
    Track& track = tracks_[sender];
    const bool lit = mask != 0;
    if (lit) track.mask = mask;
    if (begins && lit) track = {.chip = -1, .at_edge = 0, .mask = mask};
    if (lit == track.lit) return;
    track.lit = lit;
    if (!flips_[sender]) return;
    std::int64_t chip = 0;
    if (track.chip >= 0) chip = track.at_edge + (now - track.edge + chip_[sender] / 2) / chip_[sender];
    track.edge = now;
    // A chip that began by the clock a little before its edge has been looked at already.
    const bool anew = chip > track.chip;
    track.at_edge = std::max(chip, track.chip);
    track.next = now + chip_[sender];
    if (!anew) return;
    track.chip = chip - 1;
    begin_chip(now, sender);
}

/// Edges on their way to each receiver: all of them the same later, or one of them.
void IrFaults::spread(Time now, std::size_t sender, std::uint16_t mask) {
    std::vector<double> delay(boards_, 0.0);
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        const Plan& plan = plans_[f];
        CarriedFault& fault = faults_[f];
        if (plan.kind != Kind::Jitter) continue;
        const bool own = sender == plan.board;
        if (own ? !plan.sent : !plan.arriving || heard_[path(sender, plan.board)] == 0) continue;
        if (!fault.trigger.fires(now)) continue;
        const double later = plan.jitter * fault.trigger.random().uniform();
        for (std::size_t r = 0; r < boards_; ++r)
            if (own || r == plan.board) delay[r] += later;
        fault.fired(
            now, frames_[sender] - 1,
            fmt::format("{} {:.3f} us", own ? medium_.name(sender) : pair(sender, plan.board), later * 1e6));
    }
    for (std::size_t r = 0; r < boards_; ++r) {
        Seen& seen = seen_[path(sender, r)];
        Time time = now + cosim::from_seconds(delay[r]);
        if (seen.late > 0)  // edges keep their order
            for (const Late& edge : late_)
                if (edge.sender == sender && edge.receiver == r) time = std::max(time, edge.time + 1);
        if (time == now) {
            seen.mask = mask;
            continue;
        }
        ++seen.late;
        const Late edge{time, static_cast<std::uint32_t>(sender), static_cast<std::uint32_t>(r), mask};
        const auto sooner = [](const Late& a, const Late& b) { return a.time < b.time; };
        late_.insert(std::upper_bound(late_.begin(), late_.end(), edge, sooner), edge);
        again_[sender] = 1;
    }
}

void IrFaults::begin_chip(Time now, std::size_t sender) {
    Track& track = tracks_[sender];
    for (std::size_t r = 0; r < boards_; ++r)
        if (std::exchange(seen_[path(sender, r)].flipped, false)) again_[sender] = 1;
    const Time dark = track.lit ? 0 : now - track.edge;
    if (dark >= kEndChips * chip_[sender]) {
        track.next = kNever;
        track.chip = -1;
        return;
    }
    if (now > track.edge) track.next = now + chip_[sender];
    if (dark >= kDarkChips * chip_[sender]) return;
    ++track.chip;
    for (std::size_t f = 0; f < faults_.size(); ++f) {
        const Plan& plan = plans_[f];
        if (plan.kind == Kind::Flip && (plan.chip < 0 || plan.chip == track.chip)) flip(now, f, sender);
    }
}

void IrFaults::flip(Time now, std::size_t fault, std::size_t sender) {
    const Plan& plan = plans_[fault];
    const bool own = sender == plan.board;
    if (own ? !plan.sent : !plan.arriving || heard_[path(sender, plan.board)] == 0) return;
    if (!faults_[fault].trigger.fires(now)) return;
    for (std::size_t r = 0; r < boards_; ++r)
        if (own || r == plan.board) {
            bool& flipped = seen_[path(sender, r)].flipped;
            flipped = !flipped;
        }
    again_[sender] = 1;
    faults_[fault].fired(now, frames_[sender] - 1,
                         fmt::format("{} chip {}", own ? medium_.name(sender) : pair(sender, plan.board),
                                     tracks_[sender].chip));
}

}  // namespace puckloop::physics
