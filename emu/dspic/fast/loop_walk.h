#pragma once
// The symbolic walk through one iteration of a loop: see skip_loops.h.

#include "emu/dspic/core/machine.h"
#include "emu/dspic/fast/skip_loops.h"

#include <array>

namespace puckloop::dspic {

class LoopWalk {
  public:
    /// Unknown: an instruction that the walk will never follow. NotNow: this state does not allow it.
    enum class Verdict : std::uint8_t { Pure, NotNow, Unknown };

    /// A walk that only looks on (waits/): it may read registers whose reads have side effects, goes on for
    /// longer, and may take one word to hold something else than it does.
    struct Probe {
        bool on = false;
        int most_steps = 200;
        std::int32_t address = -1;  ///< of a register or RAM word; -1: none
        std::uint16_t flip = 0;     ///< bits of it to invert
    };

    LoopWalk(const Machine& m, SkipLoops::Plan& plan, LoopTrace& trace) : m_(m), plan_(plan), trace_(trace) {}
    LoopWalk(const Machine& m, SkipLoops::Plan& plan, LoopTrace& trace, const Probe& probe)
        : m_(m), plan_(plan), trace_(trace), probe_(probe) {}
    /// Walks from `head` until `branch` is taken again, twice: to find the steps, then to prove them.
    Verdict analyse(const Op* branch, const Op* head);
    /// One walk from `head` until `branch` is taken again; false if it does not come round.
    bool comes_round(const Op* branch, const Op* head);
    /// The walk came by a conditional branch or skip.
    bool chose() const { return chose_; }

  private:
    /// v + step * n after n iterations; within its width for every n up to the bound found so far.
    struct Value {
        std::int32_t v = 0;
        std::int32_t step = 0;
    };
    struct Flag {
        bool known = false;
        bool value = false;
    };
    struct Stop {
        Verdict verdict;
    };

    void walk(const Op* branch, const Op* head);
    const Op* execute(const Op* op);
    const Op* execute_data(const Op* op);
    const Op* execute_logic(const Op* op);
    const Op* execute_skip(const Op* op);
    bool holds(FormId id);
    void hazards(const Op* op);
    void record(const Op* op);
    void settle_flags();

    // Cells.
    SkipLoops::Cell& cell(std::uint16_t key);
    Value read_cell(std::uint16_t key);
    void write_cell(std::uint16_t key, Value value);
    void note_access(std::uint16_t address, std::int32_t value, bool write);
    Value w(int reg) { return read_cell(static_cast<std::uint16_t>(reg)); }
    void set_w(int reg, Value value);
    std::uint16_t constant_w(int reg);
    std::uint16_t step_pointer(int reg, int pre, int post);
    Value load(std::uint16_t address, bool byte);
    std::uint16_t poll(std::uint16_t address);
    std::uint16_t probed(std::uint16_t address, std::uint16_t value) const {
        return address == probe_.address ? value ^ probe_.flip : value;
    }
    void store(std::uint16_t address, Value value, bool byte);
    Value half(Value word, bool high);
    Value joined(Value word, Value byte, bool high);
    Value get_register(int reg, bool byte);
    void put_register(int reg, Value value, bool byte);
    Value source(const Op* op);
    void destination(const Op* op, Value value);
    void push(std::uint16_t value);
    std::uint16_t pop();
    void check_stack(std::uint16_t address) const;

    // Arithmetic.
    void hold(std::int64_t value, std::int64_t step, std::int64_t low, std::int64_t high);
    Value add(Value a, Value b, int carry, bool byte, bool sticky_z);
    Value subtract(Value a, Value b, int carry, bool byte, bool sticky_z);
    void set_nz(Value result, bool byte);
    bool flag(Flag& flag);
    std::uint32_t constant(Value value);
    [[noreturn]] static void fail(Verdict verdict) { throw Stop{verdict}; }

    const Machine& m_;
    SkipLoops::Plan& plan_;
    LoopTrace& trace_;
    Probe probe_;
    std::array<SkipLoops::Cell*, 16> w_{};                              ///< the W registers among the cells
    std::array<SkipLoops::Cell, SkipLoops::Plan::kMostCells> first_{};  ///< what the first walk found
    std::size_t first_count_ = 0;                                       ///< 0: this is the first walk
    std::uint64_t bound_ = 0;
    std::uint32_t watch_ = 0;
    bool chose_ = false;
    Flag c_, z_, n_, ov_;
};

}  // namespace puckloop::dspic
