#pragma once
// The walk through a service routine (isr_summary.h). Its domain (machine/execute/words.h defines what that
// is) has names for what the routine finds: registers by their numbers, the stack by offsets from the
// interrupted stack pointer, constants. It leaves by an exception where the routine does more than a summary
// can say.

#include "emu/dspic/fast/isr_summary.h"
#include "emu/dspic/machine/execute/number_operations.h"
#include "emu/dspic/walk/symbolic_execution.h"

#include <array>
#include <vector>

namespace puckloop::dspic {

class SymbolicIsr : public SymbolicRoutine<SymbolicIsr>, public NumberOperations<SymbolicIsr> {
    friend SymbolicExecution<SymbolicIsr>;
    friend SymbolicRoutine<SymbolicIsr>;

  public:
    using Word = IsrSummary::Word;
    struct Value {
        Word kind{};
        std::uint16_t value = 0;
        bool operator==(const Value&) const = default;
    };
    using Address = Value;
    /// Thrown: the routine has no summary.
    struct Stop {};
    enum class End : std::uint8_t { Done, NotYet, Never };

    SymbolicIsr(const Machine& m, IsrSummary& result, int irq);
    /// Walks from the routine's first instruction to RETFIE. NotYet: parts of it were never executed.
    End run(const Op* op);

    static Value value(std::uint32_t number) { return {Word::Constant, static_cast<std::uint16_t>(number)}; }
    static std::uint32_t word(Value value);
    static Address address(std::uint16_t number) { return value(number); }
    static Value complement(bool byte, Value operand) { return value(word(operand) ^ ones(byte)); }

    Value whole(int reg) const { return w_[static_cast<std::size_t>(reg)]; }
    void set_whole(int reg, Value value);
    Value part(int reg, bool byte) const { return byte ? value(word(whole(reg)) & 0xFF) : whole(reg); }
    void put(int reg, bool byte, Value operand) {
        set_whole(reg, byte ? value((word(whole(reg)) & 0xFF00) | (word(operand) & 0xFF)) : operand);
    }

    Value load(Address at, bool byte) const;
    void store(Address at, bool byte, Value value);
    /// Only the routine's own interrupt flag may be changed, and only cleared.
    template <class Change>
    void change(Address at, bool byte, Change change) {
        // Every bit of the result hangs on the same bit of the operand alone.
        const std::uint32_t set = word(change(value(0))) & ones(byte);
        const std::uint32_t cleared = ~word(change(value(ones(byte)))) & ones(byte);
        clear_flag(at, byte, set, cleared);
    }
    static Value plus(Value value, std::uint16_t offset);

    // Flags are not followed: RETFIE brings back SR<7:0>, so setting them leaves nothing behind, except DC,
    // which the adder sets and which is not stacked.
    bool c() const { throw Stop{}; }
    bool z() const { throw Stop{}; }
    bool n() const { throw Stop{}; }
    bool ov() const { throw Stop{}; }
    bool dc() const { throw Stop{}; }
    bool daw_clears_carry() const { return false; }
    bool accumulator(std::uint16_t) const { throw Stop{}; }
    void set_c(bool) {}
    void set_z(bool) {}
    Value add(bool, bool, Value, Value, bool) { throw Stop{}; }
    Value logic(bool byte, Value result) { return value(word(result) & ones(byte)); }
    Value shifted(bool byte, Value result, bool) { return logic(byte, result); }
    Value moved(bool, Value value) { return value; }

    void clear_watchdog() { throw Stop{}; }

  private:
    [[noreturn]] static void leave() { throw Stop{}; }
    auto& cycles() { return summary_.cycles; }
    auto& depth() { return summary_.depth; }
    void clear_flag(Address at, bool byte, std::uint32_t set, std::uint32_t cleared);
    void refresh(std::uint16_t address, std::uint16_t value);
    bool restored() const;
    End walk(const Op* op);

    const Machine& m_;
    IsrSummary& summary_;
    int irq_;
    std::array<Value, 16> w_{};
    std::vector<IsrSummary::Push> slots_;
    bool flag_cleared_ = false;
};

}  // namespace puckloop::dspic
