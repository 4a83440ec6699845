#pragma once
// The instruction set as a table: one Form a line of isa_forms.inc. Decoder, disassembler and assembler all
// read this and nothing else.

#include <cstdint>
#include <span>
#include <string_view>

namespace puckloop::dspic {

/// One name for every line of the table, aliases included.
enum class FormId : std::uint8_t {
#define FORM(id, ...) id,
#define ALIAS(id, ...) id,
#include "emu/dspic/machine/isa_forms.inc"
#undef FORM
#undef ALIAS
};

/// Which pointer a read-after-write stall of one cycle hangs on.
enum class Stall : std::uint8_t { Never, Source, W14, W15, Prefetch };

/// One instruction form. See isa_forms.inc for the letters of `pattern` and the codes of `flags`.
struct Form {
    FormId id{};
    std::string_view name;      ///< the line's identifier, "ADD_f_WREG"
    std::string_view mnemonic;  ///< "ADD", "MOV.B", "BRA OV"
    std::string_view operands;  ///< "Wb,Ws,Wd"
    std::string_view pattern;   ///< 24 characters, bit 23 first
    std::string_view pattern2;  ///< second word, or empty
    std::uint8_t cycles = 0;    ///< at its cheapest
    std::uint8_t psv_extra = 0;
    Stall stall = Stall::Never;
    std::string_view flags;        ///< C Z OV N DC OA OB SA SB
    std::string_view constraints;  ///< legal field values, clauses separated by ';'
    bool alias = false;            ///< a second spelling of words that an earlier form covers
    std::uint32_t mask = 0;        ///< bits that the pattern fixes
    std::uint32_t value = 0;       ///< and their values

    bool two_words() const { return !pattern2.empty(); }
    bool has_field(char letter) const { return pattern.find(letter) != std::string_view::npos; }
    /// The bits of `word` under `letter`, most significant first, packed into an unsigned number; 0 if none.
    std::uint32_t field(char letter, std::uint32_t word) const { return extract(pattern, letter, word); }
    /// The same in the second word.
    std::uint32_t field2(char letter, std::uint32_t word2) const { return extract(pattern2, letter, word2); }
    /// Spreads the low bits of `value` over `letter`'s places: the inverse of field().
    std::uint32_t place(char letter, std::uint32_t number) const { return spread(pattern, letter, number); }
    std::uint32_t place2(char letter, std::uint32_t number) const { return spread(pattern2, letter, number); }
    /// Number of bits under `letter` in the first word.
    int width(char letter) const;

    static std::uint32_t extract(std::string_view pattern, char letter, std::uint32_t word);
    static std::uint32_t spread(std::string_view pattern, char letter, std::uint32_t number);
};

/// Every form in table order; forms()[size_t(id)].id == id.
std::span<const Form> forms();
const Form& form(FormId id);

/// True when `word` has the form's fixed bits and every field value is legal. Works for aliases too.
bool matches(const Form& form, std::uint32_t word);

/// The one form (never an alias) that `word`, 24 bits, belongs to; null if it is undefined.
const Form* find_form(std::uint32_t word);

}  // namespace puckloop::dspic
