#pragma once
// One instruction from mnemonic and operands to words: every form of the mnemonic is tried, the table's
// constraints have the last word.

#include "emu/dspic/assembler/expression.h"
#include "emu/dspic/assembler/operand.h"

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace puckloop::dspic {

/// What is wrong with an instruction and what was expected; the assembler adds file and line.
class EncodeError : public std::runtime_error {
  public:
    EncodeError(const std::string& problem, std::string expected_text)
        : std::runtime_error(problem), expected(std::move(expected_text)) {}
    std::string expected;
};

struct Encoded {
    std::array<std::uint32_t, 2> words{};
    int count = 0;
};

/// The text of one instruction, taken apart.
struct Instruction {
    static constexpr std::size_t kMostOperands = 8;
    std::string_view mnemonic;
    std::array<Operand, kMostOperands> operands{};
    std::size_t operand_count = 0;
    std::string_view ignored_bits;  ///< "x=0x12,w=3" out of the braces

    std::span<const Operand> list() const { return {operands.data(), operand_count}; }
};

/// Splits "mov.w w0, [w1+w2] {g=7}". Throws EncodeError.
Instruction parse_instruction(std::string_view text);

/// Number of words: known from the shapes alone, before labels have values. Throws EncodeError.
int size_of(const Instruction& instruction);

/// Throws EncodeError or ExpressionError.
Encoded encode(const Instruction& instruction, std::uint32_t address, const SymbolValue& value_of);

}  // namespace puckloop::dspic
