#pragma once
// One handler per primary line of forms.inc, named like the line.

#include "emu/avr/machine/alu.h"
#include "emu/avr/machine/machine.h"

namespace puckloop::avr::execute {

#define FORM(id, ...) const Op* id(Machine& m, const Op* op);
#define ALIAS(...)
#define SYNONYM(...)
#include "emu/avr/isa/forms.inc"
#undef FORM
#undef ALIAS
#undef SYNONYM

/// A word that no form covers.
const Op* undefined(Machine& m, const Op* op);

inline std::uint8_t rd(const Machine& m, const Op* op) {
    return m.data[op->d];
}
inline std::uint8_t rr(const Machine& m, const Op* op) {
    return m.data[op->r];
}
/// The immediate operand of an 8-bit instruction.
inline std::uint8_t k8(const Op* op) {
    return static_cast<std::uint8_t>(op->k);
}
inline void set_rd(Machine& m, const Op* op, std::uint8_t value) {
    m.data[op->d] = value;
}
/// Replaces the flags in `mask`.
inline void set_flags(Machine& m, std::uint8_t mask, std::uint8_t flags) {
    m.sreg = static_cast<std::uint8_t>((m.sreg & ~mask) | flags);
}
/// 0 or 1.
inline std::uint8_t carry(const Machine& m) {
    return m.sreg & sreg::C;
}

}  // namespace puckloop::avr::execute
