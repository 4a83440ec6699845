#pragma once
// One instruction from mnemonic and operands to words: every form of the mnemonic is tried.

#include "emu/assembly/expression.h"

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop::avr {

/// What is wrong with an instruction and what was expected; the assembler adds file and line.
class EncodeError : public std::runtime_error {
  public:
    EncodeError(const std::string& problem, std::string expected_text)
        : std::runtime_error(problem), expected(std::move(expected_text)) {}
    std::string expected;
};

struct Encoded {
    std::array<std::uint16_t, 2> words{};
    int count = 0;
};

/// Number of words: known from the mnemonic alone, before labels have values. Throws EncodeError.
int size_of(std::string_view instruction);

/// The instruction at byte address `address`. Throws EncodeError or assembly::ExpressionError.
Encoded encode(std::string_view instruction, std::uint32_t address, const assembly::SymbolValue& value_of);

/// lo8(), hi8(), hh8() and pm() of a number, register names.
std::int64_t evaluate(std::string_view text, std::uint32_t here, const assembly::SymbolValue& value_of);

/// 0..31 for "r0".."r31" and xl, xh, yl ... zh in any case, or -1.
int register_number(std::string_view name);

}  // namespace puckloop::avr
