// Addition, subtraction, comparison, logic and shifts.

#include "emu/avr/machine/execute/handlers.h"

namespace puckloop::avr::execute {

namespace {

const Op* put(Machine& m, const Op* op, Alu<std::uint8_t> result, std::uint8_t mask = kHsvnzc) {
    set_rd(m, op, result.value);
    set_flags(m, mask, result.flags);
    return op + 1;
}

const Op* compare(Machine& m, const Op* op, Alu<std::uint8_t> result) {
    set_flags(m, kHsvnzc, result.flags);
    return op + 1;
}

const Op* put_logic(Machine& m, const Op* op, int value) {
    return put(m, op, logic(static_cast<std::uint8_t>(value)), kSvnz);
}

const Op* shift(Machine& m, const Op* op, std::uint8_t from_above) {
    return put(m, op, shift_right(rd(m, op), from_above), kSvnzc);
}

Alu<std::uint8_t> sum(std::uint8_t d, std::uint8_t r, std::uint8_t carry = 0) {
    return add(d, r, carry);
}
Alu<std::uint8_t> rest(std::uint8_t d, std::uint8_t r, std::uint8_t borrow = 0) {
    return subtract(d, r, borrow);
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
    return put(m, op, sum(rd(m, op), rr(m, op)));
}
const Op* ADC(Machine& m, const Op* op) {
    return put(m, op, sum(rd(m, op), rr(m, op), carry(m)));
}
const Op* SUB(Machine& m, const Op* op) {
    return put(m, op, rest(rd(m, op), rr(m, op)));
}
const Op* SUBI(Machine& m, const Op* op) {
    return put(m, op, rest(rd(m, op), k8(op)));
}
const Op* SBC(Machine& m, const Op* op) {
    return put(m, op, chained(rest(rd(m, op), rr(m, op), carry(m)), m.sreg));
}
const Op* SBCI(Machine& m, const Op* op) {
    return put(m, op, chained(rest(rd(m, op), k8(op), carry(m)), m.sreg));
}
const Op* NEG(Machine& m, const Op* op) {
    return put(m, op, rest(0, rd(m, op)));
}

const Op* CP(Machine& m, const Op* op) {
    return compare(m, op, rest(rd(m, op), rr(m, op)));
}
const Op* CPI(Machine& m, const Op* op) {
    return compare(m, op, rest(rd(m, op), k8(op)));
}
const Op* CPC(Machine& m, const Op* op) {
    return compare(m, op, chained(rest(rd(m, op), rr(m, op), carry(m)), m.sreg));
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
    return put(m, op, count(static_cast<std::uint8_t>(rd(m, op) + 1), 0x80), kSvnz);
}
const Op* DEC(Machine& m, const Op* op) {
    return put(m, op, count(static_cast<std::uint8_t>(rd(m, op) - 1), 0x7F), kSvnz);
}

const Op* AND(Machine& m, const Op* op) {
    return put_logic(m, op, rd(m, op) & rr(m, op));
}
const Op* ANDI(Machine& m, const Op* op) {
    return put_logic(m, op, rd(m, op) & k8(op));
}
const Op* OR(Machine& m, const Op* op) {
    return put_logic(m, op, rd(m, op) | rr(m, op));
}
const Op* ORI(Machine& m, const Op* op) {
    return put_logic(m, op, rd(m, op) | k8(op));
}
const Op* EOR(Machine& m, const Op* op) {
    return put_logic(m, op, rd(m, op) ^ rr(m, op));
}
const Op* COM(Machine& m, const Op* op) {
    Alu<std::uint8_t> result = logic(static_cast<std::uint8_t>(~rd(m, op)));
    result.flags |= sreg::C;
    return put(m, op, result, kSvnzc);
}

const Op* LSR(Machine& m, const Op* op) {
    return shift(m, op, 0);
}
const Op* ROR(Machine& m, const Op* op) {
    return shift(m, op, static_cast<std::uint8_t>(carry(m) << 7));
}
const Op* ASR(Machine& m, const Op* op) {
    return shift(m, op, rd(m, op) & 0x80);
}
const Op* SWAP(Machine& m, const Op* op) {
    set_rd(m, op, static_cast<std::uint8_t>(rd(m, op) << 4 | rd(m, op) >> 4));
    return op + 1;
}

}  // namespace puckloop::avr::execute
