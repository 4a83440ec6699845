#include "emu/dspic/fast/fast_forward.h"

#include "emu/dspic/fast/isr_summary.h"
#include "emu/dspic/machine/machine.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

namespace puckloop::dspic {

namespace {

constexpr std::uint64_t kFewestPassed = 2;
constexpr std::size_t kMostServices = 4096;

/// An interrupt that comes in during the skip.
struct PassedService {
    std::uint32_t boundary = 0;
    std::uint64_t iteration = 0;  ///< counted from the skip's start
};

struct Skip {
    EventQueue::Slot slot = 0;
    EventQueue::Steady steady;
    const IsrSummary* summary = nullptr;
    Cycle due = kNoCycle;  ///< of the steady event
    Cycle horizon = 0;     ///< no arrival at or after this

    // Where it ends.
    Cycle arrival = 0;
    std::uint64_t iterations = 0;
    std::size_t services = 0;
};

/// The loop does not look at what the interrupts change on their way.
bool polls_interrupts(const Machine& m, const IdleLoops::Plan& plan) {
    for (std::size_t i = 0; i < plan.polled_count; ++i) {
        const std::uint16_t address = plan.polled[i].address;
        if (address >= m.device.ifs && address < m.device.ifs + 2 * m.device.ifs_words) return true;
        if (m.device.inttreg && address == m.device.inttreg) return true;
    }
    return false;
}

/// True if the loop reads, before it writes it again, a word up to `depth` bytes above the stack pointer of
/// some boundary.
bool live_above_stack(const LoopTrace& trace, std::uint16_t depth) {
    for (std::size_t i = 0; i < trace.boundaries.size(); ++i) {
        const std::uint16_t stack = trace.boundaries[i].w[15];
        std::array<std::uint16_t, 64> written{};
        std::size_t count = 0;
        // Once around from here.
        const auto first =
            std::find_if(trace.accesses.begin(), trace.accesses.end(),
                         [&](const LoopTrace::Access& access) { return access.boundary >= i; });
        const auto start = static_cast<std::size_t>(first - trace.accesses.begin());
        for (std::size_t k = 0; k < trace.accesses.size(); ++k) {
            const LoopTrace::Access& access = trace.accesses[(start + k) % trace.accesses.size()];
            if (static_cast<std::uint16_t>(access.address - stack) >= depth) continue;
            const auto end = written.begin() + static_cast<std::ptrdiff_t>(count);
            if (std::find(written.begin(), end, access.address) != end) continue;
            if (!access.write || count == written.size()) return true;
            written[count++] = access.address;
        }
    }
    return false;
}

/// What the skip may pass; false if it may not begin.
bool prepare(Machine& m, IdleLoops::Branch& known, Skip& skip) {
    LoopTrace& trace = known.trace;
    if (!trace.steady || m.limit == 0 || m.mode != PowerMode::Run || m.eligible || m.disi_waits ||
        m.st.disi_end > m.st.cycle || m.st.sr & sr::RA || m.observer.on_interrupt)
        return false;
    skip.slot = m.events.next_slot();
    skip.due = m.events.next();
    skip.steady = m.events.steady(skip.slot);
    const int irq = skip.steady.irq;
    if (skip.due == kNoCycle || irq < 0 || m.irq.tapped(irq) || m.irq.gated(irq) || !m.irq.enabled(irq) ||
        m.irq.priority(irq) <= cpu_level(m))
        return false;
    if (m.irq.first().level != 0 || m.irq.any_enabled_flag()) return false;
    skip.summary = isr_summary(m, irq + kTrapVectors);
    if (!skip.summary || skip.summary->uses & m.watch & 0xFFFF0000 || !refreshes_hold(m, *skip.summary))
        return false;
    skip.horizon = std::min(m.until, m.events.next_except(skip.slot));
    if (trace.depth < skip.summary->depth) {
        trace.depth = skip.summary->depth;
        trace.live = polls_interrupts(m, known.plan) || live_above_stack(trace, trace.depth);
    }
    if (trace.live) return false;
    std::optional<std::uint16_t> held;  // most loops stay where they are on the stack
    for (const LoopTrace::Boundary& boundary : trace.boundaries) {
        if (held == boundary.w[15]) continue;
        held = boundary.w[15];
        if (!stack_holds(m, skip.summary->depth, *held)) return false;
    }
    return true;
}

/// Follows loop and interrupts up to the last arrival before the horizon, at most `most` iterations on.
void simulate(const IdleLoops::Plan& plan, const LoopTrace& trace, Skip& skip, Cycle arrival,
              std::uint64_t most, std::vector<PassedService>& services) {
    const Cycle length = plan.cycles;
    Cycle base = arrival;  // when the iteration under way began, had it not been interrupted
    Cycle due = skip.due;
    std::uint64_t iteration = 0;
    skip.arrival = arrival;
    while (services.size() < kMostServices) {
        const Cycle room = skip.horizon > base ? (skip.horizon - 1 - base) / length : 0;
        const auto commit = [&](std::uint64_t whole) {
            whole = std::min({whole, room, most - iteration});
            if (whole == 0) return;
            skip.arrival = base + whole * length;
            skip.iterations = iteration + whole;
            skip.services = services.size();
        };
        if (due >= skip.horizon) return commit(room);
        // The first boundary after the flag is set.
        std::uint64_t whole = 0;
        std::size_t boundary = 0;
        if (due >= base) {
            whole = (due - base) / length;
            const Cycle within = (due - base) % length;
            const auto after = std::upper_bound(
                trace.boundaries.begin(), trace.boundaries.end(), within,
                [](Cycle offset, const LoopTrace::Boundary& b) { return offset < b.offset; });
            boundary = static_cast<std::size_t>(after - trace.boundaries.begin());
            if (after == trace.boundaries.end()) {
                ++whole;
                boundary = 0;
            }
        }
        commit(whole);
        iteration += whole;
        if (iteration >= most) return;
        base += whole * length;
        // A flag that is set just when a return begins shortens it.
        const LoopTrace::Boundary& before =
            boundary != 0 ? trace.boundaries[boundary - 1] : trace.boundaries.back();
        const Cycle begins = base + before.offset - (boundary != 0 ? 0 : length);
        if (begins == due && shortened_by_exception(*before.op)) return;
        const LoopTrace::Boundary& at = trace.boundaries[boundary];
        const Cycle end = service_start(due, base + at.offset) + skip.summary->cycles;
        if (end > skip.horizon || end > due + skip.steady.period) return;
        services.push_back({static_cast<std::uint32_t>(boundary), iteration});
        base = end - at.offset - (at.stall ? 1 : 0);
        due += skip.steady.period;
    }
}

/// An empty list, whose memory is kept: one at a time.
std::vector<PassedService>& no_services() {
    static thread_local std::vector<PassedService> services;
    services.clear();
    return services;
}

std::uint16_t& word(Machine& m, std::uint16_t address) {
    return m.ram[(address - kRamStart) / 2];
}

void repeat_writes(Machine& m, const LoopTrace& trace, std::uint32_t from) {
    for (const LoopTrace::Access& access : trace.accesses)
        if (access.write && access.boundary >= from) word(m, access.address) = access.value;
}

void push_at(Machine& m, const LoopTrace& trace, const IsrSummary& summary, const PassedService& service) {
    const LoopTrace::Boundary& at = trace.boundaries[service.boundary];
    const auto sr = static_cast<std::uint16_t>((m.st.sr & ~unsigned{at.known}) | at.flags);
    push_trace(m, summary, {at.w.data(), sr, m.pc_of(at.op)});
}

}  // namespace

bool steady_event_next(Machine& m) {
    const int irq = m.events.steady(m.events.next_slot()).irq;
    return irq >= 0 && !m.irq.gated(irq) && m.irq.enabled(irq) && isr_summary(m, irq + kTrapVectors);
}

std::uint64_t fast_forward_arrival(Machine& m, IdleLoops::Branch& known, std::uint64_t arrival,
                                   std::uint64_t iterations, bool& interrupted) {
    Skip skip;
    if (!prepare(m, known, skip)) return kNoCycle;
    std::vector<PassedService>& services = no_services();
    simulate(known.plan, known.trace, skip, arrival, iterations, services);
    interrupted = skip.services > 0;
    return skip.iterations == iterations ? skip.arrival : kNoCycle;
}

bool fast_forward(Machine& m, IdleLoops::Branch& known, std::uint64_t arrival) {
    Skip skip;
    if (!prepare(m, known, skip)) return false;
    std::vector<PassedService>& services = no_services();
    const LoopTrace& trace = known.trace;
    simulate(known.plan, trace, skip, arrival, known.plan.iterations - 1, services);
    if (skip.iterations < kFewestPassed || skip.services == 0) return false;

    services.resize(skip.services);
    for (const PassedService& service : services)
        push_at(m, trace, *skip.summary, service);
    // The last iteration in its order: what the loop writes, and what interrupts put over it afterwards.
    repeat_writes(m, trace, 0);
    for (const PassedService& service : services) {
        if (service.iteration + 1 != skip.iterations) continue;
        push_at(m, trace, *skip.summary, service);
        repeat_writes(m, trace, service.boundary);
    }
    const int irq = skip.steady.irq;
    m.irq.acknowledge({m.irq.priority(irq), irq + kTrapVectors}, cpu_level(m));
    m.events.pass(skip.slot, skip.services);
    m.watch &= skip.summary->keep | 0xFFFFu;
    m.repeat_first = true;
    m.st.cycle += skip.arrival - arrival;
    m.instructions += skip.iterations * known.plan.instructions + skip.services * skip.summary->instructions;
    m.limit = std::min(m.until, m.events.next());
    known.plan.iterations -= skip.iterations;
    ++m.skip->skips;
    m.skip->skipped_cycles += skip.arrival - arrival;
    known.plan.gained += skip.arrival - arrival;
    m.skip->passed_services += skip.services;
    FastWork& work = m.skip->work;
    work.loop_instructions += skip.iterations * known.plan.instructions;
    work.service_instructions += skip.services * skip.summary->instructions;
    work.services += skip.services;
    return true;
}

}  // namespace puckloop::dspic
