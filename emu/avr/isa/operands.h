#pragma once
// The operand column of forms.inc, parsed: which field an operand is and how its number reads.

#include "emu/avr/isa/isa.h"

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::avr {

enum class OperandKind : std::uint8_t {
    Register,      ///< `first` + `step` * field
    SameRegister,  ///< one register, written to fields d and r
    Constant,      ///< 0 .. 2^width - 1
    Complement,    ///< written as the complement of the field
    Bit,           ///< 0..7
    Io,            ///< I/O address
    Program,       ///< byte address in the text, word address in the field
    Relative,      ///< the same, relative to the next instruction
    Data,          ///< data address
    Pointer,       ///< X, X+, -X ...: nothing to encode
    Displacement,  ///< Y+q, Z+q
};

struct OperandSpec {
    OperandKind kind{};
    char letter = 0;         ///< of the field; of the pointer for Pointer and Displacement
    std::uint8_t first = 0;  ///< register of field value 0
    std::uint8_t step = 1;   ///< registers from one field value to the next
    std::string_view text;   ///< as in the table: "X+"

    constexpr std::uint8_t register_of(std::uint32_t field) const {
        return static_cast<std::uint8_t>(first + step * field);
    }
};

inline constexpr std::size_t kMostOperands = 2;

struct OperandList {
    std::array<OperandSpec, kMostOperands> items{};
    std::size_t count = 0;

    std::span<const OperandSpec> list() const { return {items.data(), count}; }
};

/// Of each form, parsed once.
const OperandList& operands_of(FormId id);

/// The word address that a relative field of `width` bits leads to from an instruction at word `here`.
constexpr std::uint32_t relative_target(std::uint32_t here, std::uint32_t field, int width) {
    const std::uint32_t sign = 1u << (width - 1);
    const std::uint32_t offset = (field ^ sign) - sign;  // sign extended
    return (here + 1 + offset) & (kProgramBytes / 2 - 1);
}

}  // namespace puckloop::avr
