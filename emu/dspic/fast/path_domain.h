#pragma once
// The walk through a service routine along the path that it takes from the machine's present state
// (isr_path.h). Its domain (see machine/execute/words.h) carries numbers together with where they come
// from: a word that the routine found plus a constant. Where an instruction needs the number itself, or
// a flag that hangs on it, the path gets a condition on that word under which the outcome is the same. It
// leaves by an exception where the routine does more than a path can hold.

#include "emu/dspic/fast/isr_path.h"
#include "emu/dspic/machine/execute/number_operations.h"
#include "emu/dspic/walk/symbolic_execution.h"

#include <array>
#include <cstdint>
#include <initializer_list>
#include <vector>

namespace puckloop::dspic {

class PathDomain : public SymbolicRoutine<PathDomain>, public NumberOperations<PathDomain> {
    friend SymbolicExecution<PathDomain>;
    friend SymbolicRoutine<PathDomain>;

  public:
    struct Value {
        enum class Kind : std::uint8_t {
            Constant,
            Word,      ///< of the word found at `cell`, plus `offset`
            LowByte,   ///< of that word
            HighByte,  ///< of that word
            Unknown    ///< of the stack, not written by the routine
        };
        Kind kind = Kind::Constant;
        std::uint16_t cell = 0;  ///< data address
        std::uint16_t offset = 0;
        std::uint16_t now = 0;  ///< the number on this walk
        bool operator==(const Value&) const = default;
    };
    using Address = Value;
    /// Thrown: this path cannot be remembered.
    struct Stop {};

    /// `start`: the cycle at which the routine begins.
    PathDomain(Machine& m, IsrPath& result, int irq, Cycle start);
    /// From the routine's first instruction to RETFIE; false if the path cannot be remembered.
    bool walk(const Op* op);

    static Value value(std::uint32_t number) {
        return {Value::Kind::Constant, 0, 0, static_cast<std::uint16_t>(number)};
    }
    std::uint32_t word(const Value& value);
    static Address address(std::uint16_t number) { return value(number); }
    Value complement(bool byte, const Value& operand) { return value(word(operand) ^ ones(byte)); }

    Value whole(int reg) { return joined(w_[static_cast<std::size_t>(reg)]); }
    void set_whole(int reg, const Value& value);
    Value part(int reg, bool byte) {
        return byte ? half(w_[static_cast<std::size_t>(reg)], false) : whole(reg);
    }
    void put(int reg, bool byte, const Value& value);

    Value load(const Address& at, bool byte);
    void store(const Address& at, bool byte, const Value& value);
    template <class Change>
    void change(const Address& at, bool byte, Change change) {
        if (clears_flag(at, byte, word(change(value(0))), word(change(value(ones(byte)))))) return;
        store(at, byte, change(load(at, byte)));
    }
    static Value plus(Value value, std::uint16_t offset);

    // Flags: computed when somebody asks for them, since that costs a condition. RETFIE brings back SR<7:0>.
    bool c() { return flag(c_, sr::C); }
    bool z() { return flag(z_, sr::Z); }
    bool n() { return flag(n_, sr::N); }
    bool ov() { return flag(ov_, sr::OV); }
    bool dc() const { throw Stop{}; }
    bool daw_clears_carry() const { throw Stop{}; }
    bool accumulator(std::uint16_t) const { throw Stop{}; }
    void set_c(bool on) { c_ = known(on); }
    void set_z(bool on) { z_ = known(on); }
    Value add(bool byte, bool sticky, Value a, Value b, bool carry);
    Value logic(bool byte, const Value& result);
    Value shifted(bool byte, const Value& result, bool out) {
        set_c(out);
        return logic(byte, result);
    }
    Value moved(bool byte, const Value& value);

    const Op* branch(const Op* op, bool conditional);
    void clear_watchdog() { throw Stop{}; }

  private:
    using Kind = Value::Kind;
    /// A register or word: one value, or its two bytes.
    struct Slot {
        Value whole;
        bool split = false;
        Value low{}, high{};
    };
    /// A word of memory: RAM or a register by its address, or a word of the stack by its offset.
    struct Place {
        bool stack = false;
        std::uint16_t at = 0;
        Slot slot;
        bool written = false;
    };
    struct Flag {
        enum class From : std::uint8_t { Program, Known, Sum, Moved };
        From from = From::Program;
        bool value = false;
    };
    static Flag known(bool on) { return {Flag::From::Known, on}; }

    [[noreturn]] static void leave() { throw Stop{}; }
    auto& cycles() { return path_.cycles; }
    auto& depth() { return path_.depth; }
    const std::uint16_t* cell(std::uint16_t address) const;
    Value found(std::uint16_t at) const;
    void hold(const Value& value, int low, int high);
    /// The value, which a flag hangs on, stays between two of these numbers, where the flag changes.
    void hold_between(const Value& value, std::initializer_list<std::uint32_t> changes);
    bool flag(Flag& flag, std::uint16_t bit);
    bool flag_of_sum(std::uint16_t bit);
    bool flag_of_moved(std::uint16_t bit);
    Value byte_of(const Value& word, bool high);
    Value half(const Slot& slot, bool high);
    void set_half(Slot& slot, bool high, const Value& byte);
    Value joined(Slot& slot);

    bool may_close_loop(const Op* op) const;
    /// At a backward branch that is taken; `at`: its start, as note_arrival() has it, from the routine's.
    void arrive(const Op* branch, const Op* head, Cycle at);
    void check_readable(std::uint16_t at);
    Place& known_place(bool stack, std::uint16_t at);
    Place& place(const Address& at, bool byte, bool writes);
    void store_register(const Address& at, bool byte, const Value& value);
    bool clears_flag(const Address& at, bool byte, std::uint32_t set, std::uint32_t kept);

    IsrPath::Term term(const Value& value) const;
    void finish();
    void order_stores();

    Machine& m_;
    IsrPath& path_;
    const int irq_;
    const Cycle start_;
    Cycle instruction_ = 0;  ///< start of the present one, from the routine's
    std::array<Slot, 16> w_{};
    std::vector<Place> places_;
    struct Bound {
        std::uint16_t cell = 0;
        int low = 0, high = 0;
    };
    std::vector<Bound> bounds_;
    Flag c_, z_, n_, ov_;
    struct {
        Value a, b;
        bool byte = false, carry = false, done = false;
    } sum_;
    Value moved_;
    bool flag_cleared_ = false;
};

}  // namespace puckloop::dspic
