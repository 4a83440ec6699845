#pragma once
// The instruction set as a table: one Form per line of forms.inc. Decoder, disassembler, assembler and census
// read this and nothing else.

#include "emu/avr/isa/bits.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::avr {

/// One name for every line of the table.
enum class FormId : std::uint8_t {
#define FORM(id, ...) id,
#define ALIAS(id, ...) id,
#define SYNONYM(id, ...) id,
#include "emu/avr/isa/forms.inc"
#undef FORM
#undef ALIAS
#undef SYNONYM
    Undefined  ///< a word that no form covers
};

/// Cycles beyond the cheapest case.
enum class Extra : std::uint8_t { None, Taken, Skip };

/// What a line is for: every word has one Primary form; the disassembler prefers its Alias if it has one; a
/// Synonym is only read by the assembler.
enum class Role : std::uint8_t { Primary, Alias, Synonym };

struct Form {
    FormId id = FormId::Undefined;
    Role role = Role::Primary;
    std::string_view name;      ///< the line's identifier, "LD_X_INC"
    std::string_view mnemonic;  ///< "ld"
    std::string_view operands;  ///< "Rd,X+"
    BitPattern pattern;
    BitPattern second;  ///< of a two-word instruction
    bool two_words = false;
    std::uint8_t cycles = 0;  ///< at its cheapest
    Extra extra = Extra::None;
    std::string_view flags;  ///< I T H S V N Z C, codes as in forms.inc

    /// Bits under `letter` in both words, the first word's more significant.
    constexpr std::uint32_t field(char letter, std::uint16_t word, std::uint16_t next) const {
        const std::uint32_t high = pattern.field(letter, word);
        return two_words ? high << second.width(letter) | second.field(letter, next) : high;
    }
    constexpr int width(char letter) const {
        return pattern.width(letter) + (two_words ? second.width(letter) : 0);
    }
};

/// Every line in table order; forms()[size_t(id)].id == id.
std::span<const Form> forms();
const Form& form(FormId id);

/// The Primary form of a first word; null if it is undefined on this part.
const Form* find_form(std::uint16_t word);
FormId find_form_id(std::uint16_t word);

/// The Alias that the disassembler writes for `word`, or its Primary form; null if it is undefined.
const Form* find_spelling(std::uint16_t word);

/// Words that the instruction beginning with `word` takes; an undefined word takes one.
int length_of(std::uint16_t word);

/// Program addresses in text count bytes and wrap at the end of a 16-bit program counter's reach.
inline constexpr std::uint32_t kProgramBytes = 0x20000;

}  // namespace puckloop::avr
