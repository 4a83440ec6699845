#include "emu/dspic/waits/wait_watch.h"

#include "emu/dspic/machine/machine.h"
#include "emu/dspic/waits/loop_conditions.h"
#include "emu/dspic/waits/status_bits.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

constexpr double kUnknownRate = 14'745'600.0;  ///< the e-puck's
constexpr double kFirstLook = 0.1;  ///< s in a loop, before it is looked at; then at three times that, ...
constexpr double kStale = 0.5;      ///< s without an arrival end a stay
constexpr Cycle kNextLook = 3;
constexpr std::size_t kMostPolls = 100;

Cycle seconds(const Machine& m, double length) {
    return static_cast<Cycle>(length * (m.cycle_rate > 0 ? m.cycle_rate : kUnknownRate));
}

/// The program is at the stay's branch.
void look(const Machine& m, WaitWatch::Stay& stay) {
    stay.next_look = stay.last + kNextLook * (stay.last - stay.since);
    stay.finding = find_conditions(m, stay.branch, stay.head);
}

}  // namespace

void note_rate(Machine& m) {
    m.waits.stale_after = seconds(m, kStale);
}

void note_arrival(Machine& m, const Op* branch, const Op* head) {
    note_arrival(m, {branch, head, m.st.w[15], cpu_level(m), m.st.cycle});
}

void note_arrival(Machine& m, const Arrival& arrival) {
    WaitWatch& watch = m.waits;
    for (; watch.level > arrival.level; --watch.level)
        watch.stays[static_cast<std::size_t>(watch.level)].branch = nullptr;
    watch.level = arrival.level;
    WaitWatch::Stay& stay = watch.stays[static_cast<std::size_t>(arrival.level)];
    const Cycle now = arrival.now;
    if (stay.branch == arrival.branch) [[likely]] {
        if (now < stay.next_look) {
            stay.last = now;
            return;
        }
        if (now < stay.last + seconds(m, kStale)) {
            stay.last = now;
            return look(m, stay);
        }
    } else if (stay.branch != nullptr) {
        if (is_inside(stay, arrival.branch, arrival.stack) && now < stay.last + seconds(m, kStale)) return;
    }
    stay.branch = arrival.branch;
    stay.head = arrival.head;
    stay.stack = arrival.stack;
    stay.since = stay.last = now;
    stay.next_look = now + seconds(m, kFirstLook);
    stay.finding.reset();
}

bool needs_look(const Machine& m, const Arrival& arrival) {
    const WaitWatch::Stay& stay = m.waits.stays[static_cast<std::size_t>(arrival.level)];
    return arrival.level <= m.waits.level && stay.branch == arrival.branch && arrival.now >= stay.next_look;
}

void note_skip(Machine& m, const Op* branch) {
    WaitWatch::Stay& stay = m.waits.stays[static_cast<std::size_t>(m.waits.level)];
    if (stay.branch != branch) return;
    stay.last = m.st.cycle;
    if (stay.last >= stay.next_look) look(m, stay);
}

void note_polls(Machine& m, const Op* branch, const Op* head) {
    if (m.waits.polls.size() >= kMostPolls) return;
    const std::optional<LoopFinding> finding = find_conditions(m, branch, head);
    if (!finding) return;
    for (const LoopCondition& condition : finding->conditions) {
        if (condition.address >= SfrSpace::kWords * 2 || !condition.exact) continue;  // RAM
        const RegisterInfo* info = m.sfr.info(condition.address);
        if (!info) continue;
        const std::uint16_t missing =
            m.sfr.modelled(condition.address) ? missing_bits(m.device, *info) : 0xFFFF;
        const auto bits = static_cast<std::uint16_t>(condition.mask & missing);
        // Known already, should the loop have been forgotten meanwhile (its code changed, a state was
        // loaded).
        const bool known =
            std::any_of(m.waits.polls.begin(), m.waits.polls.end(), [&](const MissingPoll& poll) {
                return poll.first == finding->first && poll.last == finding->last &&
                       poll.condition.address == condition.address && poll.condition.mask == bits;
            });
        if (bits && !known)
            m.waits.polls.push_back({m.st.cycle, finding->first, finding->last, {condition.address, bits}});
    }
}

const WaitWatch::Stay* present_stay(const Machine& m, int& level) {
    for (level = m.waits.level; level >= 0; --level) {
        const WaitWatch::Stay& stay = m.waits.stays[static_cast<std::size_t>(level)];
        if (stay.branch != nullptr && stay.finding && m.st.cycle < stay.last + seconds(m, kStale))
            return &stay;
    }
    return nullptr;
}

}  // namespace puckloop::dspic
