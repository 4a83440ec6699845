// Addition, subtraction, comparison, logic and shifts.

#include "emu/avr/core/execute/handlers.h"

namespace puckloop::avr::execute {

namespace {

const Op* put(Machine& m, const Op* op, Alu result, std::uint8_t mask = kHsvnzc) {
    set_rd(m, op, result.value);
    set_flags(m, mask, result.flags);
    return op + 1;
}

const Op* compare(Machine& m, const Op* op, std::uint8_t flags) {
    set_flags(m, kHsvnzc, flags);
    return op + 1;
}

const Op* logic(Machine& m, const Op* op, int value) {
    const auto byte = static_cast<std::uint8_t>(value);
    return put(m, op, {byte, sign_flags(byte, false)}, kSvnz);
}

const Op* shift_right(Machine& m, const Op* op, int from_above) {
    const std::uint8_t d = rd(m, op);
    const auto value = static_cast<std::uint8_t>(from_above | d >> 1);
    return put(m, op, {value, shift_flags(value, d & 1)}, kSvnzc);
}

/// ADIW and SBIW: `carry` and `overflow` come from bit 15 before and after.
const Op* put_word(Machine& m, const Op* op, std::uint16_t value, bool carry, bool overflow) {
    set_pair(m, op->d, value);
    const bool negative = value >> 15;
    set_flags(m, kSvnzc,
              static_cast<std::uint8_t>((negative != overflow ? sreg::S : 0) | (overflow ? sreg::V : 0) |
                                        (negative ? sreg::N : 0) | (value == 0 ? sreg::Z : 0) |
                                        (carry ? sreg::C : 0)));
    return op + 1;
}

}  // namespace

const Op* ADD(Machine& m, const Op* op) {
    return put(m, op, add(rd(m, op), rr(m, op), false));
}
const Op* ADC(Machine& m, const Op* op) {
    return put(m, op, add(rd(m, op), rr(m, op), carry(m)));
}
const Op* SUB(Machine& m, const Op* op) {
    return put(m, op, subtract(rd(m, op), rr(m, op), false));
}
const Op* SUBI(Machine& m, const Op* op) {
    return put(m, op, subtract(rd(m, op), k8(op), false));
}
const Op* SBC(Machine& m, const Op* op) {
    const Alu result = subtract(rd(m, op), rr(m, op), carry(m));
    return put(m, op, {result.value, chained(m, result.flags)});
}
const Op* SBCI(Machine& m, const Op* op) {
    const Alu result = subtract(rd(m, op), k8(op), carry(m));
    return put(m, op, {result.value, chained(m, result.flags)});
}
const Op* NEG(Machine& m, const Op* op) {
    return put(m, op, subtract(0, rd(m, op), false));
}

const Op* CP(Machine& m, const Op* op) {
    return compare(m, op, subtract(rd(m, op), rr(m, op), false).flags);
}
const Op* CPI(Machine& m, const Op* op) {
    return compare(m, op, subtract(rd(m, op), k8(op), false).flags);
}
const Op* CPC(Machine& m, const Op* op) {
    return compare(m, op, chained(m, subtract(rd(m, op), rr(m, op), carry(m)).flags));
}

const Op* ADIW(Machine& m, const Op* op) {
    const std::uint16_t before = pair(m, op->d);
    const auto value = static_cast<std::uint16_t>(before + op->k);
    return put_word(m, op, value, (~value & before) >> 15 & 1, (value & ~before) >> 15 & 1);
}
const Op* SBIW(Machine& m, const Op* op) {
    const std::uint16_t before = pair(m, op->d);
    const auto value = static_cast<std::uint16_t>(before - op->k);
    return put_word(m, op, value, (value & ~before) >> 15 & 1, (~value & before) >> 15 & 1);
}

const Op* INC(Machine& m, const Op* op) {
    const auto value = static_cast<std::uint8_t>(rd(m, op) + 1);
    return put(m, op, {value, sign_flags(value, value == 0x80)}, kSvnz);
}
const Op* DEC(Machine& m, const Op* op) {
    const auto value = static_cast<std::uint8_t>(rd(m, op) - 1);
    return put(m, op, {value, sign_flags(value, value == 0x7F)}, kSvnz);
}

const Op* AND(Machine& m, const Op* op) {
    return logic(m, op, rd(m, op) & rr(m, op));
}
const Op* ANDI(Machine& m, const Op* op) {
    return logic(m, op, rd(m, op) & k8(op));
}
const Op* OR(Machine& m, const Op* op) {
    return logic(m, op, rd(m, op) | rr(m, op));
}
const Op* ORI(Machine& m, const Op* op) {
    return logic(m, op, rd(m, op) | k8(op));
}
const Op* EOR(Machine& m, const Op* op) {
    return logic(m, op, rd(m, op) ^ rr(m, op));
}
const Op* COM(Machine& m, const Op* op) {
    const auto value = static_cast<std::uint8_t>(~rd(m, op));
    return put(m, op, {value, static_cast<std::uint8_t>(sign_flags(value, false) | sreg::C)}, kSvnzc);
}

const Op* LSR(Machine& m, const Op* op) {
    return shift_right(m, op, 0);
}
const Op* ROR(Machine& m, const Op* op) {
    return shift_right(m, op, carry(m) ? 0x80 : 0);
}
const Op* ASR(Machine& m, const Op* op) {
    return shift_right(m, op, rd(m, op) & 0x80);
}
const Op* SWAP(Machine& m, const Op* op) {
    set_rd(m, op, static_cast<std::uint8_t>(rd(m, op) << 4 | rd(m, op) >> 4));
    return op + 1;
}

}  // namespace puckloop::avr::execute
