#pragma once
// Busy-wait loops, skipped forward without changing anything observable.
//
// At a short backward branch that is taken, one iteration is walked through symbolically from the machine's
// present state: every W register and RAM word is a value that changes by a constant step an iteration, or
// not at all. The walk knows a subset of the instructions and follows calls and inner branches; whatever it
// does not know, every write to a register, and every read of a register with side effects ends it. It yields
//   - the iteration's length in cycles and instructions, stalls included,
//   - the step of every cell that an iteration reads before it writes it,
//   - how many iterations take the same path: no addition wraps, no sign and no zero changes on the way.
//   - the registers that it polls, and their values.
// The next real iteration must end in the state that the walk predicted; only then are iterations skipped,
// at most up to the next event, and one fewer than could be, so that a real one sets flags and scratch cells.
// A loop that changes nothing at all from iteration to iteration (it waits for somebody else) is skipped
// together with the interrupts that leave no trace (isr_summary.h): see fast_forward.h. Other interrupts come
// in where they do: loop_advance.h goes from one to the next.
//
// A plan stays good over events and interrupts for as long as its cells and registers are as predicted at
// every arrival at the branch.

#include "emu/dspic/fast/fast_work.h"
#include "emu/dspic/fast/loop_table.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace puckloop::dspic {

struct Machine;
struct Op;

/// One iteration, instruction by instruction. Numbers are those of the iteration that was walked, number 0;
/// in iteration n they are larger by n steps.
struct LoopTrace {
    struct Number {
        std::int32_t v = 0;
        std::int32_t step = 0;
    };
    /// What an instruction put through the adder, which leaves DC.
    struct Sum {
        bool done = false;
        bool byte = false;
        bool carry = false;
        Number a, b;
    };
    /// Between two instructions: where an interrupt may come in.
    struct Boundary {
        const Op* op = nullptr;    ///< the next instruction
        std::uint32_t offset = 0;  ///< cycles from the loop's head
        bool stall = false;        ///< of one cycle, before it; an interrupt takes its place
        Sum sum;                   ///< of the instruction
        std::uint16_t known = 0;   ///< flags that the iteration has set by then, bits as in SR
        std::uint16_t flags = 0;
        std::array<std::uint16_t, 16> w{};
        std::array<std::int16_t, 16> w_steps{};
        std::uint16_t written = 0;  ///< registers that the iteration has written by then
        std::uint16_t writes = 0;   ///< registers that the instruction writes
    };
    struct Access {
        std::uint32_t boundary = 0;  ///< before the instruction that does it
        std::uint16_t address = 0;
        std::uint16_t value = 0;
        bool write = false;
        std::int16_t step = 0;
    };
    std::vector<Boundary> boundaries;
    std::vector<Access> accesses;
    std::uint64_t iterations = 0;  ///< that go the same way; 0: the trace is no good
    bool steady = false;           ///< the loop changes nothing
    std::uint16_t depth = 0;       ///< bytes above the stack pointer known to be dead at every boundary
    bool live = false;             ///< there are live ones

    void clear() {
        boundaries.clear();
        accesses.clear();
        steady = live = false;
        iterations = depth = 0;
    }
};

/// DC after the sum, in an iteration.
inline bool dc_of(const LoopTrace::Sum& sum, std::uint64_t iteration) {
    const auto in = [&](const LoopTrace::Number& number) {
        return static_cast<std::uint32_t>(number.v) + static_cast<std::uint32_t>(number.step) * iteration;
    };
    const std::uint64_t a = in(sum.a), b = in(sum.b);
    return (a ^ b ^ (a + b + (sum.carry ? 1 : 0))) & (sum.byte ? 0x10 : 0x100);
}

struct IdleLoops {
    /// A cell of the loop: 0..15 a W register, above a RAM byte address.
    struct Cell {
        std::uint16_t key = 0;
        std::int32_t start = 0;     ///< at the loop's head
        std::int32_t now = 0;       ///< where the walk stands; after it: an iteration later
        std::int32_t now_step = 0;  ///< what `now` changes by an iteration
        std::int32_t step = 0;      ///< what `start` changes by an iteration
        bool carried = false;       ///< read before written: what one iteration hands to the next
        bool written = false;
    };
    struct Plan {
        static constexpr std::size_t kMostCells = 40;
        std::array<Cell, kMostCells> cells{};
        std::size_t count = 0;
        std::uint64_t cycles = 0;
        std::uint64_t instructions = 0;
        std::uint64_t iterations = 0;  ///< still to come on the same path, the one under way included
        bool clears_watchdog = false;
        struct Polled {
            std::uint16_t address = 0;
            std::uint16_t value = 0;
        };
        static constexpr std::size_t kMostPolled = 8;
        std::array<Polled, kMostPolled> polled{};
        std::size_t polled_count = 0;
        std::uint32_t layout = 0;  ///< SfrSpace::layout_changes(): a stored word is what a read returns

        bool alive = false;
        bool proven = false;          ///< a real iteration ended as the walk predicted
        bool used = false;            ///< it has skipped something
        std::uint64_t proof_due = 0;  ///< cycle at which the proof must be there, nothing in between ...
        /// An arrival at this cycle ends an iteration that began as predicted: every scratch cell and flag is
        /// as an undisturbed iteration leaves it.
        std::uint64_t clean_due = 0;
        bool proof_interrupted = false;  ///< ... but routines without a trace

        /// So many iterations have been.
        void advance(std::uint64_t count);
        /// So many are still to come.
        void catch_up(std::uint64_t to_come) { advance(iterations - to_come); }
    };
    /// What is known of one backward branch.
    struct Branch {
        std::uint16_t place = 0;    ///< in `branches` and `waits`
        std::uint8_t patience = 0;  ///< failures in a row
        bool polls_noted = false;   ///< note_polls() was called for it
        bool walked = false;        ///< a walk came round once: no way out of the loop decides for all of it
        Plan plan;
        LoopTrace trace;
        LoopTable table;          ///< of the trace, once it is wanted
        std::uint32_t noted = 0;  ///< by the LoopUndo with this stamp ...
        std::size_t note = 0;     ///< ... at this place
    };
    std::vector<std::uint16_t> index;  ///< by program word: place in `branches` plus 1, 0 = not seen yet
    std::deque<Branch> branches;
    std::vector<std::uint16_t> waits;  ///< by branch: arrivals until the next try
    LoopPosition position;
    FastWork work;
    std::uint64_t skips = 0;  ///< for tests and curiosity
    std::uint64_t skipped_cycles = 0;
    std::uint64_t passed_services = 0;  ///< routines without a trace that fell into skips
};

/// Makes the table of the branch's plan and trace; these stay as they are as long as it is used.
void make_table(Machine& m, IdleLoops::Branch& known);

}  // namespace puckloop::dspic
