#include "emu/dspic/fast/idle_loops.h"

#include "emu/dspic/fast/fast_forward.h"
#include "emu/dspic/fast/known_services.h"
#include "emu/dspic/fast/loop_advance.h"
#include "emu/dspic/fast/loop_undo.h"
#include "emu/dspic/machine/machine.h"
#include "emu/dspic/waits/wait_watch.h"
#include "emu/dspic/walk/symbolic_loop.h"

#include <algorithm>
#include <utility>

namespace puckloop::dspic {

namespace {

/// With less than this to the next event a walk is not begun.
constexpr Cycle kWorthwhile = 64;
constexpr std::uint8_t kMostPatience = 10;
/// For loops that no walk came round yet.
constexpr std::uint8_t kMostPatienceUnknown = 15;
constexpr std::uint64_t kFewestIterations = 4;
/// A plan that has skipped fewer cycles cost more to find than translated code takes for them. Measured: of
/// 4,000 to 40,000 the range-and-bearing boards' original images take the same time, of 1 up to 1.8 times it.
constexpr Cycle kPays = 10'000;

std::uint16_t& word_of(Machine& m, std::uint16_t key) {
    return key < 16 ? m.st.w[key] : m.ram[(key - kRamStart) / 2];
}

IdleLoops::Branch& branch_at(Machine& m, std::size_t word) {
    IdleLoops& skip = *m.skip;
    if (skip.index.empty()) skip.index.assign(m.code_words + kGuards, 0);
    if (skip.index[word] == 0) {
        skip.branches.emplace_back().place = static_cast<std::uint16_t>(skip.waits.size());
        skip.waits.push_back(0);
        skip.index[word] = static_cast<std::uint16_t>(skip.branches.size());
        publish_loops(m);
    }
    return skip.branches[skip.index[word] - 1u];
}

/// The machine stands where the plan expects it, at the branch.
bool as_predicted(Machine& m, const IdleLoops::Plan& plan, Cycle arrival) {
    if (plan.polled_count != 0 && plan.layout != m.sfr.layout_changes()) return false;
    for (std::size_t i = 0; i < plan.polled_count; ++i)
        if (m.sfr.raw(plan.polled[i].address) != plan.polled[i].value) return false;
    if (!plan.proven && plan.proof_due != arrival) return false;
    for (std::size_t i = 0; i < plan.count; ++i) {
        const IdleLoops::Cell& cell = plan.cells[i];
        // Scratch, an interrupt may have used it.
        if (!cell.carried && (plan.proven || (plan.proof_interrupted && cell.key >= 16))) continue;
        if (word_of(m, cell.key) != static_cast<std::uint16_t>(cell.now)) return false;
    }
    return true;
}

/// Skips as many iterations as the plan and the limit allow, less one. True if the limit decided: then
/// the real iteration that follows is over before the limit, and the next one is not.
bool skip_iterations(Machine& m, IdleLoops::Plan& plan, Cycle arrival) {
    if (m.limit < arrival) return false;
    const std::uint64_t room = (m.limit - arrival) / plan.cycles;
    if (room < 2 || plan.iterations < 2) return false;
    const std::uint64_t count = std::min(plan.iterations - 1, room - 1);
    plan.advance(count);
    for (std::size_t i = 0; i < plan.count; ++i)
        if (plan.cells[i].carried)
            word_of(m, plan.cells[i].key) = static_cast<std::uint16_t>(plan.cells[i].now);
    const Cycle cycles = count * plan.cycles;
    m.st.cycle += cycles;
    m.instructions += count * plan.instructions;
    m.skip->work.loop_instructions += count * plan.instructions;
    if (plan.clears_watchdog) {
        m.watchdog_cleared += cycles;
        schedule_watchdog(m);
    }
    plan.gained += cycles;
    ++m.skip->skips;
    m.skip->skipped_cycles += cycles;
    return count + 1 == room;
}

/// Registers that the loop does not touch may hold something else than when it was walked.
void adopt_registers(const Machine& m, IdleLoops::Branch& known) {
    if (!known.trace.steady || known.trace.boundaries.front().w == m.st.w) return;
    std::uint32_t touched = 0;
    for (std::size_t i = 0; i < known.plan.count; ++i)
        if (known.plan.cells[i].key < 16) touched |= 1u << known.plan.cells[i].key;
    for (LoopTrace::Boundary& boundary : known.trace.boundaries)
        for (std::size_t reg = 0; reg < 16; ++reg)
            if (!(touched >> reg & 1)) boundary.w[reg] = m.st.w[reg];
}

void give_up_for_now(Machine& m, IdleLoops::Branch& known) {
    const std::uint8_t most = known.walked ? kMostPatience : kMostPatienceUnknown;
    if (known.patience < most) ++known.patience;
    m.skip->waits[known.place] = static_cast<std::uint16_t>((1u << known.patience) - 1);
}

void make_plan(Machine& m, IdleLoops::Branch& known, const Op* branch, const Op* head, Cycle arrival) {
    IdleLoops::Plan& plan = known.plan;
    m.loop_undo->note_walk(known);
    known.table.trace = nullptr;
    plan.layout = m.sfr.layout_changes();
    ++m.skip->work.loop_walks;
    SymbolicLoop walk(m, plan, known.trace);
    switch (walk.analyse(branch, head)) {
    case SymbolicLoop::Verdict::Pure:
        known.walked = true;
        if (plan.iterations < kFewestIterations) return give_up_for_now(m, known);
        plan.alive = true;
        plan.proven = false;
        plan.gained = 0;
        plan.proof_due = arrival + plan.cycles;
        plan.proof_interrupted = false;
        if (m.limit < plan.proof_due) {
            plan.proof_due = fast_forward_arrival(m, known, arrival, 1, plan.proof_interrupted);
            plan.alive = plan.proof_due != kNoCycle;
            if (!plan.alive && !known.trace.steady) return give_up_for_now(m, known);
        }
        ++m.skip->work.loop_plans;
        --plan.iterations;  // the one that runs now
        break;
    case SymbolicLoop::Verdict::NotNow:
        give_up_for_now(m, known);
        break;
    case SymbolicLoop::Verdict::Unknown:
        // On its last round a loop leaves by instructions that the walk need not know.
        if (known.walked || walk.chose()) return give_up_for_now(m, known);  // another way round may do
        if (m.program_undo.on())
            m.program_undo.note_operation(m, static_cast<std::uint32_t>(branch - m.code));
        m.code[branch - m.code].may_skip = false;
        ++m.skip->work.loops_refused;
        break;
    }
}

/// When the iteration that begins at `arrival` is over, if nothing but routines without a trace can come
/// between.
Cycle clean_arrival(Machine& m, IdleLoops::Branch& known, Cycle arrival) {
    if (!known.trace.steady) return kNoCycle;
    if (arrival + known.plan.cycles < m.limit) return arrival + known.plan.cycles;
    bool interrupted = false;
    return fast_forward_arrival(m, known, arrival, 1, interrupted);
}

}  // namespace

void forget_loops(Machine& m) {
    m.loop_undo->note_forgetting(m);
    m.waits.forget();
    m.skip->index.clear();
    m.skip->branches.clear();
    m.skip->waits.clear();
    m.skip->position = {};
    m.services->summaries.clear();
    m.services->paths.clear();
    publish_loops(m);
}

void publish_loops(Machine& m) {
    IdleLoops& skip = *m.skip;
    m.loop_index = skip.index.empty() ? nullptr : skip.index.data();
    m.loop_waits = skip.waits.data();
}

void try_skip(Machine& m, const Op* branch, const Op* head) {
    note_arrival(m, branch, head);
    if (!m.skip_idle || m.doze.on) return;
    IdleLoops::Branch& known = branch_at(m, static_cast<std::size_t>(branch - m.code));
    m.loop_undo->note(known);
    if (std::uint16_t& wait = m.skip->waits[known.place]; wait > 0) {
        --wait;
        return;
    }
    const Cycle arrival = m.st.cycle + branch->cycles;  // the run loop adds them after this
    if (back_in_loop(m, known)) return;
    IdleLoops::Plan& plan = known.plan;
    if (plan.alive) {
        if (plan.iterations >= 2 && as_predicted(m, plan, arrival)) {
            const bool clean = !plan.proven || plan.clean_due == arrival;
            plan.proven = true;
            if (!std::exchange(known.polls_noted, true) && plan.polled_count > 0) note_polls(m, branch, head);
            adopt_registers(m, known);
            bool to_limit = false;
            const bool forwarded = clean && fast_forward(m, known, arrival);
            if (!forwarded && enter_loop(m, known)) return;
            if (!forwarded) to_limit = skip_iterations(m, plan, arrival);
            note_skip(m, branch);
            plan.clean_due = clean_arrival(m, known, m.st.cycle + branch->cycles);
            plan.advance(1);  // the real iteration that follows
            // At its end nothing can be gained: only the arrival after that one is looked at.
            if (to_limit && !known.trace.steady && plan.iterations > 2) {
                plan.advance(1);
                m.skip->waits[known.place] = 1;
            }
            return;
        }
        plan.alive = false;
        if (plan.gained < kPays) return give_up_for_now(m, known);
        known.patience = 0;
    }
    if (m.limit < arrival + kWorthwhile && !steady_event_next(m)) return;
    make_plan(m, known, branch, head, arrival);
}

}  // namespace puckloop::dspic
