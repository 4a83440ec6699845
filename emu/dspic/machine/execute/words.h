#pragma once
// The domain of the interpreter: a value is a 16-bit word, and every effect happens to the machine.
//
// The instructions (arithmetic.h, shifts.h, moves.h, bits.h, branches.h, products.h) are templates over such
// a domain; the loop walk (walk/symbolic_loop.h), the summary and the paths of service routines
// (fast/symbolic_isr.h, fast/path_domain.h) and what the translator makes code of (translate/recipe.h) are
// more. A domain has
//   Value, Address    what a register or a memory word holds, and what reaches memory
//   Bit, Product      yes or no; 32 bits
//   value, word       from a number to a Value and back; a domain that does not know the number fails there
//   conjunction, ...  operations on values (number_operations.h)
//   whole, part, ...  registers; load, store, change: memory; source, destination: an operand of any mode
//   c, z, n, ov       flags; add, logic, shifted, set_c, set_z: what sets them
//   go, skip_if, ...  where execution continues, and what that costs
// A domain that cannot follow an effect leaves by an exception of its own.

#include "emu/dspic/machine/execute/number_operations.h"

namespace puckloop::dspic {

class Words : public NumberOperations<Words> {
  public:
    using Value = std::uint32_t;
    using Address = std::uint16_t;

    explicit Words(Machine& m) : m_(m) {}

    static Value value(std::uint32_t number) { return number; }
    static std::uint32_t word(Value value) { return value; }
    static Address address(std::uint16_t number) { return number; }
    static Value complement(bool byte, Value value) { return value ^ ones(byte); }

    // Registers. part() and put() are the low byte, or the whole.
    Value whole(int reg) const { return m_.st.w[static_cast<std::size_t>(reg)]; }
    void set_whole(int reg, Value value) { set_w(m_, reg, value); }
    Value part(int reg, bool byte) const { return whole(reg) & ones(byte); }
    void put(int reg, bool byte, Value value) {
        set_w(m_, reg, byte ? (whole(reg) & 0xFF00u) | (value & 0xFF) : value);
    }

    // Memory.
    Value load(Address at, bool byte) { return byte ? read8(m_, at) : read16(m_, at); }
    void store(Address at, bool byte, Value value) {
        byte ? write8(m_, at, static_cast<std::uint16_t>(value))
             : write16(m_, at, static_cast<std::uint16_t>(value));
    }
    /// Reads, lets `change` compute, and writes back.
    template <class Change>
    void change(Address at, bool byte, Change change) {
        store(at, byte, change(load(at, byte)));
    }
    static Address next_word(Address at) { return static_cast<Address>(at + 2); }
    /// [Ws] and [Wd] with their modifications.
    Address source_ea(const Op* op, bool byte) {
        return byte ? dspic::source_ea<false>(m_, op) : dspic::source_ea<true>(m_, op);
    }
    Address destination_ea(const Op* op, bool byte) {
        return byte ? dspic::destination_ea<false>(m_, op) : dspic::destination_ea<true>(m_, op);
    }
    /// [Wn + literal]: never modulo, but through W15 the stack limits hold.
    Address displaced(int reg, std::uint16_t literal, bool perhaps_stack) {
        const auto at = static_cast<Address>(whole(reg) + literal);
        if (perhaps_stack && reg == 15) check_stack(m_, at);
        return at;
    }
    void push(Value value) { dspic::push(m_, static_cast<std::uint16_t>(value)); }
    Value pop() { return dspic::pop(m_); }
    /// A register's value, moved: no flags.
    static Value plus(Value value, std::uint16_t offset) { return value + offset; }

    // Operands of any mode.
    template <class Shape>
    Value source(const Op* op, Shape shape) {
        if (shape.source == Ea::Literal) return op->k;
        if (shape.source == Ea::Direct) return part(op->s, shape.byte);
        if (shape.source == Ea::Indirect) return load(source_ea(op, shape.byte), shape.byte);
        return load(offset_ea(m_, op->s, m_.st.w[op->b], false), shape.byte);
    }
    template <class Shape>
    void destination(const Op* op, Shape shape, Value value) {
        if (shape.destination == Ea::Direct)
            put(op->d, shape.byte, value);
        else if (shape.destination == Ea::Indirect)
            store(destination_ea(op, shape.byte), shape.byte, value);
        else
            store(offset_ea(m_, op->d, m_.st.w[op->b], true), shape.byte, value);
    }

    // Flags.
    bool c() const { return m_.st.sr & sr::C; }
    bool z() const { return m_.st.sr & sr::Z; }
    bool n() const { return m_.st.sr & sr::N; }
    bool ov() const { return m_.st.sr & sr::OV; }
    bool dc() const { return m_.st.sr & sr::DC; }
    /// DAW.B's carry is that of its own sum alone (Erratum::DawCarry).
    bool daw_clears_carry() const { return m_.daw_clears_carry; }
    /// OA, OB, SA, SB.
    bool accumulator(std::uint16_t bit) const { return m_.st.sr & bit; }
    void set_c(bool on) { set_flags(m_, sr::C, on ? sr::C : 0u); }
    void set_z(bool on) { set_flags(m_, sr::Z, on ? sr::Z : 0u); }

    /// a + b + carry with C, Z, OV, N and DC, which is the carry out of the low half (bit 3 in byte mode, bit
    /// 7 in word mode). Subtraction passes ~b and carry = no borrow, as the silicon's adder does. `sticky`: Z
    /// is only ever cleared (ADDC, SUBB, SUBBR, CPB).
    Value add(bool byte, bool sticky, Value a, Value b, bool carry) {
        const int bits = byte ? 8 : 16;
        const std::uint32_t sum = a + b + (carry ? 1u : 0u);
        const std::uint32_t carries = a ^ b ^ sum;  // bit n = carry into bit n
        std::uint32_t flags = sum >> bits & 1;
        flags |= (sum & ones(byte)) == 0 ? sr::Z : 0u;
        flags |= ((a ^ sum) & (b ^ sum)) >> (bits - 1) << 2 & sr::OV;
        flags |= sum >> (bits - 1) << 3 & sr::N;
        flags |= byte ? carries << 4 & sr::DC : carries & sr::DC;
        if (sticky) flags &= m_.st.sr | ~std::uint32_t{sr::Z};
        set_flags(m_, sr::C | sr::Z | sr::OV | sr::N | sr::DC, flags);
        return sum & ones(byte);
    }
    /// A result that sets N and Z.
    Value logic(bool byte, std::uint32_t result) {
        set_flags(m_, sr::N | sr::Z, byte ? nz<true>(result) : nz<false>(result));
        return result;
    }
    /// A result that sets N and Z, and C from the bit shifted out; OV and DC stay.
    Value shifted(bool byte, std::uint32_t result, bool out) {
        set_flags(m_, sr::C | sr::N | sr::Z,
                  (byte ? nz<true>(result) : nz<false>(result)) | (out ? sr::C : 0u));
        return result;
    }
    /// The same of a value that is moved (MOV f).
    Value moved(bool byte, Value value) { return logic(byte, value); }

    // Flow.
    std::uint32_t pc_of(const Op* op) const { return m_.pc_of(op); }
    const Op* go(std::uint32_t pc) { return at(m_, pc); }
    /// A conditional branch that is taken, or one without a condition.
    const Op* branch(const Op* op, bool conditional) {
        if (conditional) ++m_.st.cycle;
        return at(m_, op->target);
    }
    static void decides() {}
    const Op* skip_if(const Op* op, bool condition) { return condition ? skip_next(m_, op) : op + 1; }
    /// A return is a cycle shorter while an exception waits to be taken.
    const Op* return_to(std::uint32_t pc) {
        if (m_.eligible) --m_.st.cycle;
        return at(m_, pc);
    }
    void clear_watchdog() {
        dspic::clear_watchdog(m_);
        rcon_register(m_) &= static_cast<std::uint16_t>(~(rcon::SLEEP | rcon::IDLE));
    }

  protected:
    Machine& m_;
};

/// The same for a short backward branch, which closes a loop that may be a busy wait.
class LoopingWords : public Words {
  public:
    using Words::Words;
    const Op* branch(const Op* op, bool conditional) {
        const Op* next = Words::branch(op, conditional);
        if (op->may_skip) try_skip(m_, op, next);
        return next;
    }
};

}  // namespace puckloop::dspic
