// Idle-loop elision: at a short backward branch that is taken, the turns to come are executed side by side
// (lane_walk.h), as many as there is room for before anything can happen. A loop for which that fails is
// tried again after more and more visits.

#include "emu/avr/fast/lane_walk.h"

#include <algorithm>

namespace puckloop::avr {

namespace {

/// Less room than this is not worth a walk.
constexpr Cycle kWorthwhile = 64;
/// A pin that changed is read late for a clock: no walk begins sooner after something happened outside.
constexpr Cycle kSettled = 2;
constexpr std::uint8_t kMostPatience = 11, kImpatient = 8;

}  // namespace

const Op* skip_iterations(Machine& m, const Op* branch, const Op* head) {
    LoopInfo& loop = m.loops[m.pc_of(branch)];
    const Cycle now = m.cycle + branch->cycles;  // the branch itself is over then
    if (m.limit <= now + kWorthwhile || now < m.quiet_since + kSettled) return head;
    // From here on the branch's own clocks and count are in; the run loop adds them again.
    m.cycle = now;
    ++m.instructions;
    const LaneWalk::Verdict verdict = LaneWalk(m).run(branch, head, loop);
    if (verdict == LaneWalk::Verdict::Skipped)
        loop.patience = 0;
    else
        loop.patience = std::min<std::uint8_t>(
            kMostPatience, std::max<std::uint8_t>(static_cast<std::uint8_t>(loop.patience + 1),
                                                  verdict == LaneWalk::Verdict::Never ? kImpatient : 0));
    loop.wait = static_cast<std::uint16_t>((1u << loop.patience) - 1);
    m.cycle -= branch->cycles;
    --m.instructions;
    return head;
}

}  // namespace puckloop::avr
