// One iteration, walked twice.

#include "emu/dspic/walk/symbolic_loop.h"

#include "emu/dspic/machine/execute/semantics.h"

#include <algorithm>
#include <limits>

namespace puckloop::dspic {

namespace {

constexpr std::size_t kUsualLength = 32;  ///< instructions; a longer loop takes more memory
constexpr std::uint64_t kForever = std::numeric_limits<std::int64_t>::max();

}  // namespace

void SymbolicLoop::walk(const Op* branch, const Op* head) {
    plan_.count = plan_.polled_count = 0;
    plan_.cycles = plan_.instructions = 0;
    plan_.clears_watchdog = false;
    trace_.clear();
    trace_.boundaries.reserve(kUsualLength);
    bound_ = kForever;
    watch_ = 0;
    w_ = {};
    c_ = z_ = n_ = ov_ = dc_ = {};
    const Op* op = head;
    for (int i = 0; i < probe_.most_steps; ++i) {
        record(op);
        hazards(op);
        const Op* next = execute(op);
        plan_.cycles += op->cycles;
        ++plan_.instructions;
        if (op == branch && next == head) return;
        op = next;
    }
    fail(Verdict::NotNow);
}

/// Only what the interpreter could execute next, with the pointers' hazards.
void SymbolicLoop::hazards(const Op* op) {
    if (op->run == &decode_now || op->marks != 0) fail(Verdict::NotNow);
    if (op->uses & m_.watch & 0xFFFF0000) fail(Verdict::NotNow);
    if (op->uses & watch_) ++plan_.cycles;
    watch_ = op->writes;
}

const Op* SymbolicLoop::execute(const Op* op) {
    const Op* next = execute_in<AffineDomain>(*this, op);
    if (!next) fail(Verdict::Unknown);
    return next;
}

void SymbolicLoop::record(const Op* op) {
    LoopTrace::Boundary& boundary = trace_.boundaries.emplace_back();
    boundary.op = op;
    boundary.offset = static_cast<std::uint32_t>(plan_.cycles);
    boundary.stall = op->uses & watch_;
    const auto note = [&](const Flag& flag, std::uint16_t bit) {
        if (flag.known) boundary.known |= bit;
        if (flag.known && flag.value) boundary.flags |= bit;
    };
    note(c_, sr::C);
    note(z_, sr::Z);
    note(n_, sr::N);
    note(ov_, sr::OV);
    note(dc_, sr::DC);
    for (std::size_t reg = 0; reg < 16; ++reg) {
        boundary.w[reg] = w_[reg] ? static_cast<std::uint16_t>(w_[reg]->now) : m_.st.w[reg];
        if (!w_[reg]) continue;
        boundary.w_steps[reg] = static_cast<std::int16_t>(w_[reg]->now_step);
        if (w_[reg]->written) boundary.written |= static_cast<std::uint16_t>(1u << reg);
    }
}

/// A flag or a register that an iteration sets late still has at its head what the iteration before left.
void SymbolicLoop::settle() {
    record(trace_.boundaries.front().op);
    const LoopTrace::Boundary end = trace_.boundaries.back();
    trace_.boundaries.pop_back();
    for (LoopTrace::Boundary& boundary : trace_.boundaries) {
        const auto missing = static_cast<std::uint16_t>(end.known & ~boundary.known);
        boundary.flags |= static_cast<std::uint16_t>(end.flags & missing);
        boundary.known |= missing;
        for (std::size_t reg = 0; reg < 16; ++reg) {
            if (!((end.written & ~boundary.written) >> reg & 1)) continue;
            boundary.w[reg] = static_cast<std::uint16_t>(end.w[reg] - end.w_steps[reg]);
            boundary.w_steps[reg] = end.w_steps[reg];
        }
    }
}

bool SymbolicLoop::comes_round(const Op* branch, const Op* head) {
    try {
        first_count_ = 0;
        walk(branch, head);
        return true;
    } catch (const Stop&) {
        return false;
    }
}

SymbolicLoop::Verdict SymbolicLoop::analyse(const Op* branch, const Op* head) {
    try {
        first_count_ = 0;
        walk(branch, head);
        bool moves = false;
        for (std::size_t i = 0; i < plan_.count; ++i) {
            LoopPlan::Cell& c = plan_.cells[i];
            if (!c.carried) continue;
            c.step = static_cast<std::int16_t>(static_cast<std::uint16_t>(c.now - c.start));
            moves = moves || c.step != 0;
        }
        if (moves) {
            first_ = plan_.cells;
            first_count_ = plan_.count;
            for (std::size_t i = 0; i < first_count_; ++i)
                if (!first_[i].carried) first_[i].step = 0;
            walk(branch, head);
        }
        for (std::size_t i = 0; i < plan_.count; ++i) {
            const LoopPlan::Cell& c = plan_.cells[i];
            if (c.carried && (c.now != c.start + c.step || c.now_step != c.step)) return Verdict::NotNow;
            if (c.carried) hold(c.start, c.step, 0, 0xFFFF);
        }
        plan_.iterations = bound_;
        trace_.steady = !moves && !plan_.clears_watchdog;
        if (!plan_.clears_watchdog) {
            trace_.iterations = bound_;
            settle();
        }
        return Verdict::Pure;
    } catch (const Stop& stop) {
        return stop.verdict;
    }
}

}  // namespace puckloop::dspic
