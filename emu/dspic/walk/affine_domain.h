#pragma once
// The domain of the loop walk (machine/execute/words.h defines what a domain is): a value is v + step * n
// after n iterations of the loop, and holds for every n up to a bound that each use may lower. Memory and
// registers are cells; a register of a module is a constant that the plan polls. What cannot be followed ends
// the walk.

#include "emu/dspic/machine/execute/number_operations.h"
#include "emu/dspic/walk/loop_plan.h"
#include "emu/dspic/walk/symbolic_execution.h"

#include <array>

namespace puckloop::dspic {

class AffineDomain : public SymbolicExecution<AffineDomain>, public NumberOperations<AffineDomain> {
    friend SymbolicExecution<AffineDomain>;

  public:
    /// Unknown: an instruction that no walk will ever follow. NotNow: this state does not allow it.
    enum class Verdict : std::uint8_t { Pure, NotNow, Unknown };
    /// Thrown where the walk ends.
    struct Stop {
        Verdict verdict;
    };
    [[noreturn]] static void fail(Verdict verdict) { throw Stop{verdict}; }

    /// A walk that only looks on (waits/): it may read registers whose reads have side effects, goes on for
    /// longer, and may take one word to hold something else than it does.
    struct Probe {
        bool on = false;
        int most_steps = 200;
        std::int32_t address = -1;  ///< of a register or RAM word; -1: none
        std::uint16_t flip = 0;     ///< bits of it to invert
    };

    /// Within its width for every n up to the bound found so far.
    struct Value {
        std::int32_t v = 0;
        std::int32_t step = 0;
    };
    using Address = std::uint16_t;

    static Value value(std::uint32_t number) { return {static_cast<std::int32_t>(number), 0}; }
    static std::uint32_t word(Value value);
    static Address address(std::uint16_t number) { return number; }
    static Value complement(bool byte, Value value) {
        return {static_cast<std::int32_t>(ones(byte)) - value.v, -value.step};
    }

    // Registers.
    Value whole(int reg) { return read_cell(static_cast<std::uint16_t>(reg)); }
    void set_whole(int reg, Value value);
    Value part(int reg, bool byte) { return byte ? half(whole(reg), false) : whole(reg); }
    void put(int reg, bool byte, Value value) {
        set_whole(reg, byte ? joined(whole(reg), value, false) : value);
    }

    // Memory: addresses may not change from one iteration to the next.
    Value load(Address at, bool byte);
    void store(Address at, bool byte, Value value);
    template <class Change>
    void change(Address at, bool byte, Change change) {
        store(at, byte, change(load(at, byte)));
    }
    static Address next_word(Address at) { return static_cast<Address>(at + 2); }
    Address displaced(int reg, std::uint16_t literal, bool perhaps_stack);
    static Value plus(Value value, std::uint16_t offset) {
        return {static_cast<std::uint16_t>(word(value) + offset), 0};
    }

    // Flags. One that the loop has not set yet is not known.
    bool c() const { return known(c_); }
    bool z() const { return known(z_); }
    bool n() const { return known(n_); }
    bool ov() const { return known(ov_); }
    bool dc() const { fail(Verdict::Unknown); }
    bool daw_clears_carry() const { fail(Verdict::Unknown); }
    bool accumulator(std::uint16_t) const { fail(Verdict::Unknown); }
    void set_c(bool on) { c_ = {true, on}; }
    void set_z(bool on) { z_ = {true, on}; }
    Value add(bool byte, bool sticky, Value a, Value b, bool carry);
    Value logic(bool byte, Value result) { return moved(byte, value(word(result) & ones(byte))); }
    Value shifted(bool byte, Value result, bool out) {
        set_c(out);
        return logic(byte, result);
    }
    Value moved(bool byte, Value value);

    // Flow.
    void decides() { chose_ = true; }
    void clear_watchdog() { plan_.clears_watchdog = true; }

  protected:
    AffineDomain(const Machine& m, LoopPlan& plan, LoopTrace& trace, const Probe& probe)
        : m_(m), plan_(plan), trace_(trace), probe_(probe) {}

    struct Flag {
        bool known = false;
        bool value = false;
    };
    static bool known(const Flag& flag);
    /// Lowers the bound so that value + step * n stays within [low, high]; it is there for n = 0.
    void hold(std::int64_t value, std::int64_t step, std::int64_t low, std::int64_t high);

    const Machine& m_;
    LoopPlan& plan_;
    LoopTrace& trace_;
    Probe probe_;
    std::array<LoopPlan::Cell*, 16> w_{};                       ///< the W registers among the cells
    std::array<LoopPlan::Cell, LoopPlan::kMostCells> first_{};  ///< what the first walk found
    std::size_t first_count_ = 0;                               ///< 0: this is the first walk
    std::uint64_t bound_ = 0;
    bool chose_ = false;
    Flag c_, z_, n_, ov_, dc_;

  private:
    [[noreturn]] static void leave() { fail(Verdict::NotNow); }
    auto& cycles() { return plan_.cycles; }
    LoopPlan::Cell& cell(std::uint16_t key);
    Value read_cell(std::uint16_t key);
    void write_cell(std::uint16_t key, Value value);
    void note_access(std::uint16_t address, Value value, bool write);
    bool is_ram(Address even) const { return even >= kRamStart && (even - kRamStart) / 2 < m_.ram_words; }
    Address step_pointer(int reg, int pre, int post);
    Address indexed(int reg, int index);
    void check_stack(Address at) const;
    std::uint16_t poll(Address at);
    std::uint16_t probed(Address at, std::uint16_t value) const {
        return at == probe_.address ? value ^ probe_.flip : value;
    }
    Value half(Value word, bool high);
    Value joined(Value word, Value byte, bool high);
};

}  // namespace puckloop::dspic
