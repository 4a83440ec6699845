#pragma once
// One iteration of a loop as a walk finds it (symbolic_loop.h): instruction by instruction, and what it
// makes of the cells that it reads.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::dspic {

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

/// What a walk found: how the loop goes on, and for how long.
struct LoopPlan {
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
    std::uint64_t gained = 0;     ///< cycles that it has skipped
    std::uint64_t proof_due = 0;  ///< cycle at which the proof must be there, nothing in between ...
    /// An arrival at this cycle ends an iteration that began as predicted: every scratch cell and flag is
    /// as an undisturbed iteration leaves it.
    std::uint64_t clean_due = 0;
    bool proof_interrupted = false;  ///< ... but routines without a trace

    /// So many iterations have been.
    void advance(std::uint64_t passed) {
        for (std::size_t i = 0; i < count; ++i)
            cells[i].now += static_cast<std::int32_t>(static_cast<std::int64_t>(passed) * cells[i].step);
        iterations -= passed;
    }
    /// So many are still to come.
    void catch_up(std::uint64_t to_come) { advance(iterations - to_come); }
};

}  // namespace puckloop::dspic
