#pragma once
// Which of the status flags are not in SR yet, and where their values can be had from instead: most are
// overwritten before anybody reads them, so SR is only written where it can be seen.

#include <cstdint>

namespace puckloop::dspic::translate {

struct Flags {
    enum class From : std::uint8_t {
        Sr,      ///< SR holds it
        Sum,     ///< the adder's operands and sum in r8, r9, r10
        Sticky,  ///< the same, and SR's Z must be set too
        Result,  ///< a result in r11, zero extended
        Bit,     ///< 0 or 1 in rsi
    };
    From c = From::Sr, z = From::Sr, ov = From::Sr, n = From::Sr, dc = From::Sr;
    bool sum_byte = false;
    bool result_byte = false;
    int carry = 0;  ///< that went into the sum; -1: not known when translating

    bool all_in_sr() const {
        return c == From::Sr && z == From::Sr && ov == From::Sr && n == From::Sr && dc == From::Sr;
    }
};

/// Conditions of branches; each has its opposite beside it.
enum class Test : std::uint8_t { Overflow, Carry, Zero, Negative, Less, LessOrEqual, NotAbove };

}  // namespace puckloop::dspic::translate
