#pragma once
// A loop as a table: for every boundary between two of its instructions, what registers and words hold there
// and how long they have held it. Made from a loop's plan and trace (idle_loops.h) for loop_advance.h.

#include "emu/dspic/machine/event_queue.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::dspic {

struct LoopTrace;
struct Machine;
struct Op;

struct LoopTable {
    /// What a W register or RAM word of the loop holds at a boundary.
    struct Word {
        std::uint16_t cell = 0;   ///< place in `cells`
        std::uint16_t value = 0;  ///< in iteration 0
        std::int16_t step = 0;    ///< by which it grows an iteration
        std::uint16_t age = 0;    ///< instructions since it was written, 1 to all of an iteration's
        std::uint16_t in(std::uint64_t iteration) const {
            return static_cast<std::uint16_t>(value + static_cast<std::uint32_t>(step) *
                                                          static_cast<std::uint32_t>(iteration));
        }
    };
    struct Place {
        const Op* op = nullptr;    ///< the next instruction
        std::uint32_t offset = 0;  ///< cycles from the loop's head
        std::uint32_t watch = 0;   ///< Op::writes of the instruction before
        bool stall = false;        ///< as LoopTrace::Boundary's
        bool returns = false;      ///< `op` is shortened by an exception
        std::uint16_t known = 0;   ///< flags of SR that the loop sets, less DC
        std::uint16_t flags = 0;
        std::uint16_t dc_age = 0;   ///< instructions since DC was set; 0: the loop never does
        std::uint16_t dc_from = 0;  ///< the boundary before that instruction
        std::uint16_t inner = 0;    ///< other branches that came round since the head (waits/)
        std::uint32_t checks = 0;   ///< where those of this boundary begin; they end where the next one's do
        std::uint32_t changes = 0;  ///< the same
    };
    struct Polled {
        const std::uint16_t* word = nullptr;
        std::uint16_t value = 0;
    };
    const LoopTrace* trace = nullptr;     ///< null: there is no table
    std::uint64_t* gained = nullptr;      ///< LoopPlan::gained of its plan
    Cycle cycles = 0;                     ///< of an iteration
    std::uint32_t keep = 0;               ///< what stays of Machine::watch over an iteration
    std::uint32_t uses = 0;               ///< pointers that must have been set (upper half of Op::uses)
    std::vector<std::uint16_t> first_at;  ///< by cycles from the head: the first boundary there or later
    std::vector<Place> places;            ///< by boundary, and one more
    std::vector<std::uint16_t*> cells;
    std::vector<Word> checks;   ///< that the loop reads before it writes them again
    std::vector<Word> changes;  ///< that the loop writes, the latest first
    std::vector<Polled> polled;
    std::uint32_t layout = 0;  ///< as IdleLoops::Plan's

    std::size_t count() const { return places.size() - 1; }
    const Op* branch() const { return places[count() - 1].op; }
};

/// Where the machine may be in which loop, to be checked against its state.
struct LoopPosition {
    const Op* op = nullptr;  ///< null: in none
    const LoopTable* table = nullptr;
    std::size_t boundary = 0;     ///< whose instruction `op` is
    std::uint64_t iteration = 0;  ///< by the trace
};

}  // namespace puckloop::dspic
