#include "emu/dspic/fast/loop_advance.h"

#include "emu/dspic/fast/fast_forward.h"
#include "emu/dspic/waits/wait_watch.h"

#include <algorithm>

namespace puckloop::dspic {

namespace {

using Place = LoopTable::Place;

constexpr std::uint32_t kPointers = 0xFFFF0000;  ///< of Machine::watch: not written since reset

/// What note_arrival() does at the loop's arrivals, and at those of branches within it, up to the first one
/// at or after the limit. The machine is at this boundary.
enum class Arrivals : std::uint8_t { Noted, Inside, Looked };
Arrivals arrivals(const Machine& m, const LoopTable& table, std::size_t boundary) {
    const WaitWatch::Stay& stay = m.waits.stays[static_cast<std::size_t>(cpu_level(m))];
    const auto before = [&](Cycle cycle) { return m.limit < cycle && table.cycles < cycle - m.limit; };
    const bool lasts = before(stay.last + m.waits.stale_after);
    if (stay.branch == table.branch()) {
        const bool alone = table.places[table.count() - 1].inner == 0;
        return before(stay.next_look) && (alone || lasts) ? Arrivals::Noted : Arrivals::Looked;
    }
    // The loop need not touch W15, and may be met at another depth than when it was walked.
    const auto& trace = table.trace->boundaries;
    const auto stack = static_cast<std::uint16_t>(m.st.w[15] + trace.back().w[15] - trace[boundary].w[15]);
    const bool inside = stay.branch != nullptr && is_inside(stay, table.branch(), stack);
    return inside && lasts ? Arrivals::Inside : Arrivals::Looked;
}

/// At a level where the program goes on, whatever waited above it is over.
void note_level(Machine& m) {
    const int level = cpu_level(m);
    for (; m.waits.level > level; --m.waits.level)
        m.waits.stays[static_cast<std::size_t>(m.waits.level)].branch = nullptr;
    m.waits.level = level;
}

/// Every pointer that the loop needs or sets has been set.
bool pointers_set(const Machine& m, const LoopTable& table) {
    return (m.watch & kPointers & (table.uses | ~table.keep)) == 0;
}

/// The machine's state is that of the loop at this boundary of this iteration.
bool as_traced(const Machine& m, const LoopTable& table, std::size_t boundary, std::uint64_t iteration) {
    const Place* const at = &table.places[boundary];
    if (((m.st.sr ^ at->flags) & at->known) != 0) return false;
    if (!table.polled.empty() && table.layout != m.sfr.layout_changes()) return false;
    for (const LoopTable::Polled& polled : table.polled)
        if (*polled.word != polled.value) return false;
    const LoopTable::Word* const end = table.checks.data() + at[1].checks;
    for (const LoopTable::Word* word = table.checks.data() + at->checks; word != end; ++word)
        if (*table.cells[word->cell] != word->in(iteration)) return false;
    return true;
}

/// At the loop's head, in the state of this iteration: the run loop goes on by advance_in_loop(), if it may.
bool stand_at_head(Machine& m, const LoopTable& table, std::uint64_t iteration) {
    if (m.limit == 0 || iteration >= table.trace->iterations || steady_event_next(m) ||
        arrivals(m, table, 0) == Arrivals::Looked || !pointers_set(m, table))
        return false;
    m.skip->position = {table.places.front().op, &table, 0, iteration};
    m.limit = 0;
    return true;
}

/// What `count` instructions of the loop leave behind that end at this boundary of this iteration.
void leave_state(Machine& m, const LoopTable& table, const LoopPosition& where, std::uint64_t count) {
    const Place* const at = &table.places[where.boundary];
    unsigned status = (m.st.sr & ~unsigned{at->known}) | (at->flags & at->known);
    if (at->dc_age != 0 && at->dc_age <= count) {
        const std::uint64_t iteration = where.iteration - (at->dc_from < where.boundary ? 0 : 1);
        const bool dc = dc_of(table.trace->boundaries[at->dc_from].sum, iteration);
        status = (status & ~unsigned{sr::DC}) | (dc ? sr::DC : 0u);
    }
    m.st.sr = static_cast<std::uint16_t>(status);
    const LoopTable::Word* const end = table.changes.data() + at[1].changes;
    for (const LoopTable::Word* word = table.changes.data() + at->changes; word != end && word->age <= count;
         ++word)
        *table.cells[word->cell] = word->in(where.iteration);
    m.watch = (m.watch & kPointers) | at->watch;
    m.current = at->op;
    m.instructions += count;
    m.skip->work.loop_instructions += count;
}

}  // namespace

bool enter_loop(Machine& m, IdleLoops::Branch& known) {
    if (known.trace.iterations == 0) return false;
    if (!known.table.trace) {
        if (known.plan.gained == 0) return false;  // many a plan serves once, and a table costs some skips
        make_table(m, known);
    }
    const std::uint64_t iteration = known.trace.iterations - known.plan.iterations;
    return as_traced(m, known.table, 0, iteration) && stand_at_head(m, known.table, iteration);
}

bool back_in_loop(Machine& m, IdleLoops::Branch& known) {
    LoopPosition& position = m.skip->position;
    if (position.table != &known.table || !known.table.trace) return false;
    ++position.iteration;
    if (position.iteration > known.trace.iterations || !as_traced(m, known.table, 0, position.iteration))
        return false;
    if (stand_at_head(m, known.table, position.iteration)) return true;
    known.plan.catch_up(known.trace.iterations - position.iteration);
    return false;
}

bool advance_in_loop(Machine& m) {
    LoopPosition& position = m.skip->position;
    position.op = nullptr;  // until it has gone well
    const LoopTable& table = *position.table;
    if (!table.trace) return false;
    const Place& from = table.places[position.boundary];
    const bool stalls = from.op->uses & m.watch & ~kPointers;
    if (!m.skip_idle || m.limit <= m.st.cycle || (stalls && !from.stall) ||
        (m.eligible ? from.returns : steady_event_next(m)) || !pointers_set(m, table) ||
        !as_traced(m, table, position.boundary, position.iteration))
        return false;

    // When the iteration under way began, had nothing interrupted it.
    const Cycle base = m.st.cycle - from.offset - (from.stall && !stalls ? 1 : 0);
    const Cycle span = m.limit - base;
    Cycle iterations = span < table.cycles ? 0 : span / table.cycles;
    std::size_t to = table.first_at[span - iterations * table.cycles];
    if (to == table.count()) {
        to = 0;
        ++iterations;
    }
    const std::uint64_t most = table.trace->iterations - position.iteration;
    const bool ends = iterations >= most;
    if (ends) {
        iterations = most;
        to = 0;
    }
    const bool arrives = iterations > 0 || table.places[to].inner != from.inner;
    const Arrivals which = arrives ? arrivals(m, table, position.boundary) : Arrivals::Inside;
    if (which == Arrivals::Looked) return false;
    const std::uint64_t count = iterations * table.count() + to - position.boundary;
    const Cycle head = base + iterations * table.cycles;
    const Cycle now = head + table.places[to].offset;
    position.boundary = to;
    position.iteration += iterations;
    leave_state(m, table, position, count);
    if (arrives) note_level(m);
    if (iterations > 0 && which == Arrivals::Noted)
        m.waits.stays[static_cast<std::size_t>(m.waits.level)].last = head - table.branch()->cycles;
    ++m.skip->skips;
    m.skip->skipped_cycles += now - m.st.cycle;
    *table.gained += now - m.st.cycle;
    m.st.cycle = now;
    if (!ends) position.op = table.places[to].op;
    return true;
}

}  // namespace puckloop::dspic
