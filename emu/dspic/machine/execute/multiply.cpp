// Multiplication and division of the MCU class.
// Division is one step of eighteen, repeated by REPEAT #17. The silicon keeps a partial result in W1:W0; here
// the first step latches the dividend there and the last computes the result, so an interrupt between two
// steps is safe under the same rules as on silicon (W0, W1, divisor and RCOUNT preserved).

#include "emu/dspic/devices/dspic30f6014a_sfr.h"
#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/machine/execute/products.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kINTCON1{"INTCON1"};

/// REPEAT #17 gives eighteen steps; RCOUNT counts 17 down to 0.
constexpr std::uint16_t kFirstStep = 17;

enum class Division { SignedWord, SignedDouble, UnsignedWord, UnsignedDouble, Fraction };

template <Division Kind>
void latch_dividend(Machine& m, const Op* op) {
    auto& w = m.st.w;
    const std::uint16_t low = w[op->d];
    if constexpr (Kind == Division::SignedWord) {
        w[0] = low;
        w[1] = low & 0x8000 ? 0xFFFF : 0;
    } else if constexpr (Kind == Division::UnsignedWord) {
        w[0] = low;
        w[1] = 0;
    } else if constexpr (Kind == Division::Fraction) {
        w[1] = w[op->b];
        w[0] = 0;
    } else {
        const std::uint16_t high = w[op->b];
        w[0] = low;
        w[1] = high;
    }
}

template <Division Kind>
void divide(Machine& m, const Op* op) {
    auto& w = m.st.w;
    const std::uint32_t raw = std::uint32_t{w[1]} << 16 | w[0];
    constexpr bool kUnsigned = Kind == Division::UnsignedWord || Kind == Division::UnsignedDouble;
    const std::int64_t divisor = kUnsigned ? w[op->s] : static_cast<std::int16_t>(w[op->s]);
    std::int64_t dividend = kUnsigned ? static_cast<std::int64_t>(raw) : static_cast<std::int32_t>(raw);
    if constexpr (Kind == Division::Fraction) dividend >>= 1;  // W1 << 15
    if (divisor == 0) return;                                  // the trap is on its way, nothing is defined
    const std::int64_t quotient = dividend / divisor;
    const std::int64_t remainder = dividend % divisor;
    const bool fits = kUnsigned ? quotient <= 0xFFFF : quotient >= -0x8000 && quotient <= 0x7FFF;
    set_w(m, 0, static_cast<std::uint32_t>(quotient));
    set_w(m, 1, static_cast<std::uint32_t>(remainder));
    std::uint32_t flags = (remainder == 0 ? sr::Z : 0u) | (fits ? 0u : sr::OV);
    if (!kUnsigned && remainder < 0) flags |= sr::N;
    set_flags(m, sr::Z | sr::N | sr::OV, flags);
}

template <Division Kind>
const Op* divide_step(Machine& m, const Op* op) {
    if (m.st.rcount == kFirstStep) {
        latch_dividend<Kind>(m, op);
        if (m.st.w[op->s] == 0) {
            if (m.device.family_33f) m.sfr.raw(sfr::INTCON1) |= kINTCON1["DIV0ERR"];
            raise_trap(m, Trap::MathError);
        }
    }
    if (m.st.rcount == 0) divide<Kind>(m, op);
    return op + 1;
}

Handler division(FormId id) {
    switch (id) {
    case FormId::DIV_SW_Wm_Wn:
        return &divide_step<Division::SignedWord>;
    case FormId::DIV_SD_Wm_Wn:
        return &divide_step<Division::SignedDouble>;
    case FormId::DIV_UW_Wm_Wn:
        return &divide_step<Division::UnsignedWord>;
    case FormId::DIV_UD_Wm_Wn:
        return &divide_step<Division::UnsignedDouble>;
    case FormId::DIVF_Wm_Wn:
        return &divide_step<Division::Fraction>;
    default:
        return nullptr;
    }
}

}  // namespace

bool bind_multiply(Op& op, const Form& form, std::uint32_t word) {
    if (const Handler step = division(form.id)) {
        op.s = static_cast<std::uint8_t>(form.field('s', word));
        op.d = static_cast<std::uint8_t>(form.field('v', word));  // dividend, low word
        op.b = static_cast<std::uint8_t>(form.field('t', word));  // dividend, high word
        sets(op, 0);
        sets(op, 1);
        op.base = step;
        return true;
    }
    return with_product(form.id, [&](auto semantics) { semantics.bind(op, form, word); });
}

}  // namespace puckloop::dspic
