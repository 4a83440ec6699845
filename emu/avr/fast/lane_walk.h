#pragma once
// Turns of a polling loop, executed side by side.
//
// A loop that waits for a timer reads another value of its counter in each turn, so no turn is like the one
// before. But until a turn decides otherwise they all take the same way, and hand each other the same
// registers: what differs between them is scratch. One walk around the loop therefore executes the next
// Lanes::kCount turns at once, lane n being the nth turn from now, with each read of a counter answered for
// the instants of all turns (RegisterSpace::follow()). Turns count as long as
//   - every branch and skip goes the way of the first turn,
//   - each turn ends with what the next one begins with in everything that is read before it is written,
//   - no event, interrupt or end of the grant comes between (Machine::limit).
// What the last of them leaves in registers, flags and RAM is then written back, and its reads of modules are
// done for real, so that these are as if every turn had been executed.

#include "emu/avr/fast/lanes.h"
#include "emu/avr/machine/alu.h"
#include "emu/avr/machine/machine.h"

#include <array>

namespace puckloop::avr {

class LaneWalk {
  public:
    enum class Verdict : std::uint8_t { Skipped, NotNow, Never };

    explicit LaneWalk(Machine& m) : m_(m) {}
    /// The machine is at `head`, to which `branch` leads back; the branch is over. Executes as many turns as
    /// it can, from 1 on. Never: the way round holds something that no walk will follow.
    Verdict run(const Op* branch, const Op* head, LoopInfo& loop);

  private:
    /// Thrown where the walk ends.
    struct Stop {
        Verdict verdict;
    };
    [[noreturn]] static void fail(Verdict verdict) { throw Stop{verdict}; }

    /// A byte of RAM.
    struct Cell {
        std::uint16_t address = 0;
        bool read = false;  ///< before it was written
        bool written = false;
        Lanes value;
    };
    struct Read {
        std::uint16_t address = 0;
        Cycle offset = 0;
    };
    static constexpr std::size_t kMostCells = 32, kMostReads = 16;
    static constexpr std::uint64_t kMostInstructions = 300;

    // lane_walk.cpp
    const Op* execute(const Op* op);
    const Op* branch_if(bool taken, const Op* op);
    const Op* skip_if(bool skipped, const Op* op);
    const Op* put(const Op* op, const Alu<Lanes>& result, std::uint8_t mask);
    const Op* compare(const Op* op, const Alu<Lanes>& result);
    void multiply(const Lanes& d, const Lanes& r);
    void add_word(const Op* op, std::uint16_t addend);

    // lane_memory.cpp
    Lanes reg(unsigned number);
    void set(unsigned number, const Lanes& value);
    Lanes flags(std::uint8_t mask);
    void set_flags(std::uint8_t mask, const Lanes& value);
    /// All lanes from the first one that is not as lane 0 on do not count.
    std::uint8_t uniform(const Lanes& value);
    /// True if lane 0 is 0, as all lanes that count.
    bool zero(const Lanes& value);
    std::uint16_t pointer(unsigned low);
    std::uint16_t moved_pointer(unsigned low, int before, int after);
    Lanes load(const Op* op, std::uint16_t address);
    void store(const Op* op, std::uint16_t address, const Lanes& value);
    void write_flags(const Op* op, const Lanes& value, std::uint8_t mask);
    Lanes load_module(const Op* op, std::uint16_t address);
    Cell& cell(std::uint16_t address);
    void cut(std::uint64_t different) {
        if (different) valid_ = std::min(valid_, static_cast<std::size_t>(std::countr_zero(different)));
    }
    /// Lanes behind the first one that does not hand on what it found.
    void compare_ends();
    void commit(std::size_t last, std::uint64_t turns);
    void note_steady(const Op* branch, const Op* head);

    Machine& m_;
    Cycle base_ = 0;    ///< the first turn begins
    Cycle period_ = 0;  ///< of one turn, as it was last
    Cycle offset_ = 0;  ///< from the turn's begin
    std::uint64_t instructions_ = 0;
    std::size_t valid_ = Lanes::kCount;
    std::uint16_t polled_ = 0;              ///< a register that was read and follows no clock
    bool follows_ = false;                  ///< a value that follows the clock was read
    std::uint32_t read_ = 0, written_ = 0;  ///< registers; `read`: before they were written
    std::uint8_t flags_read_ = 0, flags_written_ = 0;
    std::uint16_t sp_ = 0;
    Cycle hold_ = kNoCycle;    ///< offset of the last instruction that comes before any interrupt
    Cycle access_ = kNoCycle;  ///< offset of the last access to a register
    std::size_t cells_ = 0, reads_ = 0;
    std::array<Read, kMostReads> read_at_;
    Lanes sreg_;
    std::array<Lanes, 32> r_;
    std::array<Cell, kMostCells> cell_;
};

}  // namespace puckloop::avr
