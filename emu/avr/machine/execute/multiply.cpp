// The hardware multiplier: the product goes to R1:R0, its bit 15 to C; the fractional ones shift it left.

#include "emu/avr/machine/execute/handlers.h"

namespace puckloop::avr::execute {

namespace {

constexpr int as_signed(std::uint8_t value) {
    return static_cast<std::int8_t>(value);
}

const Op* put_product(Machine& m, const Op* op, int product, int shift) {
    const auto result = static_cast<std::uint16_t>(product << shift);
    set_pair(m, 0, result);
    set_flags(m, sreg::Z | sreg::C,
              static_cast<std::uint8_t>((result == 0 ? sreg::Z : 0) | (product >> 15 & 1 ? sreg::C : 0)));
    return op + 1;
}

}  // namespace

const Op* MUL(Machine& m, const Op* op) {
    return put_product(m, op, rd(m, op) * rr(m, op), 0);
}
const Op* MULS(Machine& m, const Op* op) {
    return put_product(m, op, as_signed(rd(m, op)) * as_signed(rr(m, op)), 0);
}
const Op* MULSU(Machine& m, const Op* op) {
    return put_product(m, op, as_signed(rd(m, op)) * rr(m, op), 0);
}
const Op* FMUL(Machine& m, const Op* op) {
    return put_product(m, op, rd(m, op) * rr(m, op), 1);
}
const Op* FMULS(Machine& m, const Op* op) {
    return put_product(m, op, as_signed(rd(m, op)) * as_signed(rr(m, op)), 1);
}
const Op* FMULSU(Machine& m, const Op* op) {
    return put_product(m, op, as_signed(rd(m, op)) * rr(m, op), 1);
}

}  // namespace puckloop::avr::execute
