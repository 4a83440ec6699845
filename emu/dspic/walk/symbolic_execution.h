#pragma once
// What the domains of this folder share (machine/execute/words.h defines what a domain is). They follow
// instructions without executing them, each with its own idea of a value; how an operand is reached through
// registers, pointers and memory, and where execution goes on, is the same for all.
//
// A domain derives from SymbolicExecution<itself> and befriends it. It brings, beside what every domain has,
//   m_                     the machine
//   step_pointer, indexed  [Wn] with its modification before or behind, [Wn + Wb]
//   cycles()               a reference to the count of cycles
//   leave()                does not return: the instruction cannot be followed

#include "emu/dspic/machine/execute/shape.h"

#include <algorithm>
#include <cstdint>

namespace puckloop::dspic {

template <class Domain>
class SymbolicExecution {
  public:
    // Operands.
    auto source_ea(const Op* op, bool) { return self().step_pointer(op->s, op->s_pre, op->s_post); }
    auto destination_ea(const Op* op, bool) { return self().step_pointer(op->d, op->d_pre, op->d_post); }
    template <class Value>
    void push(const Value& value) {
        self().store(self().step_pointer(15, 0, 2), false, value);
    }
    auto pop() { return self().load(self().step_pointer(15, -2, 0), false); }
    template <class Shape>
    auto source(const Op* op, Shape shape) {
        if (shape.source == Ea::Literal) return Domain::value(op->k & ones(shape.byte));
        if (shape.source == Ea::Direct) return self().part(op->s, shape.byte);
        const bool plain = shape.source == Ea::Indirect;
        return self().load(plain ? source_ea(op, shape.byte) : self().indexed(op->s, op->b), shape.byte);
    }
    template <class Shape, class Value>
    void destination(const Op* op, Shape shape, const Value& value) {
        if (shape.destination == Ea::Direct) return self().put(op->d, shape.byte, value);
        const bool plain = shape.destination == Ea::Indirect;
        self().store(plain ? destination_ea(op, shape.byte) : self().indexed(op->d, op->b), shape.byte,
                     value);
    }

    // Flow.
    std::uint32_t pc_of(const Op* op) const { return self().m_.pc_of(op); }
    const Op* go(std::uint32_t pc) const {
        if (pc >> 1 >= self().m_.code_words) Domain::leave();
        return self().m_.code + (pc >> 1);
    }
    const Op* return_to(std::uint32_t pc) const { return go(pc); }
    const Op* branch(const Op* op, bool conditional) {
        if (conditional) ++self().cycles();
        return go(op->target);
    }
    void decides() {}
    const Op* skip_if(const Op* op, bool condition) {
        self().decides();
        if (!condition) return op + 1;
        const bool two = is_two_words(op[1].word);
        self().cycles() += two ? 2 : 1;
        return op + (two ? 3 : 2);
    }

  private:
    Domain& self() { return static_cast<Domain&>(*this); }
    const Domain& self() const { return static_cast<const Domain&>(*this); }
};

/// The same for walks through a service routine, whose pointers are values of the domain: a number, or an
/// offset from the interrupted stack pointer. The domain befriends this one as well, and has
///   plus(), whole(), set_whole(), word()   of its values
///   depth()                                a reference to the bytes of stack that the routine needs
template <class Domain>
class SymbolicRoutine : public SymbolicExecution<Domain> {
  public:
    template <class Address>
    static Address next_word(const Address& at) {
        return Domain::plus(at, 2);
    }
    auto displaced(int reg, std::uint16_t literal, bool) { return Domain::plus(self().whole(reg), literal); }

  protected:
    auto step_pointer(int reg, int pre, int post) {
        check_pointer(reg);
        const auto at = Domain::plus(self().whole(reg), static_cast<std::uint16_t>(pre));
        if (pre != 0 || post != 0) self().set_whole(reg, Domain::plus(at, static_cast<std::uint16_t>(post)));
        return at;
    }
    auto indexed(int reg, int index) {
        check_pointer(reg);
        return Domain::plus(self().whole(reg), static_cast<std::uint16_t>(self().word(self().whole(index))));
    }
    /// The routine needs this many bytes of stack.
    void reach(std::uint32_t depth) {
        if (depth > kMostDepth) Domain::leave();
        self().depth() = std::max(self().depth(), static_cast<std::uint16_t>(depth));
    }

  private:
    /// Offsets stay far from wrapping.
    static constexpr std::uint32_t kMostDepth = 0x1000;

    void check_pointer(int reg) const {
        if (reg != 15 && self().m_.special >> reg & 1) Domain::leave();
    }
    Domain& self() { return static_cast<Domain&>(*this); }
    const Domain& self() const { return static_cast<const Domain&>(*this); }
};

}  // namespace puckloop::dspic
