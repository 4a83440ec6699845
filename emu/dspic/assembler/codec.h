#pragma once
// How a form's operands stand in its word: the operand column of the instruction table, parsed once, with
// every field's place computed. Assembler and disassembler are two walks over the same items.

#include "emu/dspic/machine/isa.h"
#include "emu/dspic/machine/memory_map.h"

#include <array>
#include <cstdint>
#include <vector>

namespace puckloop::dspic {

/// One operand, by what is written in its place.
enum class OperandKind : std::uint8_t {
    File,           ///< f: a data address
    FileBit,        ///< f,#bit4: address and bit in one go, they share a field
    Wreg,           ///< WREG
    Literal,        ///< #k, unsigned
    EvenLiteral,    ///< #k, unsigned and even, bit 0 not stored (LNK)
    SignedLiteral,  ///< #k, signed (SFTAC)
    Bit,            ///< #b
    Register,       ///< a plain W register
    RegisterPair,   ///< an even W register, stored halved
    Source,         ///< W with mode p or g
    Destination,    ///< W with mode q or h
    SourceOffset,   ///< [Ws+Slit10]
    DestinationOffset,
    Relative,       ///< branch target: PC+2+2*n
    Absolute,       ///< CALL, GOTO target over two words
    LoopEnd,        ///< DO: PC+4+2*n in the second word
    Accumulator,    ///< a or b
    OptionalShift,  ///< {#Slit4}
    Product,        ///< Wm*Wn, two of W4..W7
    Square,         ///< Wm*Wm
    PrefetchX,      ///< {[W8]+=2,W4}
    PrefetchY,      ///< {[W10]+=2,W5}
    PointerX,       ///< [W8]+=2 without a destination (ED, EDAC)
    PointerY,
    DifferenceTarget,  ///< Wxd of ED, EDAC
    WriteBack,         ///< {W13} or {[W13]+=2}
};

struct OperandItem {
    OperandKind kind{};
    char letter = 0;  ///< the field of a Register, RegisterPair, Literal
};

/// Where a letter's bits stand. `width` 0: the form has no such field.
struct FieldPlace {
    std::uint8_t shift = 0;
    std::uint8_t width = 0;
    bool contiguous = true;
};

class FormCodec {
  public:
    explicit FormCodec(const Form& form);

    const Form& form() const { return *form_; }
    const std::vector<OperandItem>& items() const { return items_; }
    bool has(char letter) const { return place(letter).width != 0; }
    int width(char letter) const { return place(letter).width; }
    std::uint32_t get(char letter, std::uint32_t word) const {
        const FieldPlace& at = place(letter);
        if (at.contiguous) return word >> at.shift & ((1u << at.width) - 1);
        return form_->field(letter, word);
    }
    std::uint32_t put(char letter, std::uint32_t number) const {
        const FieldPlace& at = place(letter);
        if (at.contiguous) return (number & ((1u << at.width) - 1)) << at.shift;
        return form_->place(letter, number);
    }
    char source_mode() const { return has('p') ? 'p' : 'g'; }
    char destination_mode() const { return has('q') ? 'q' : 'h'; }

  private:
    const FieldPlace& place(char letter) const { return places_[static_cast<std::size_t>(letter - 'A')]; }
    void parse_operands();

    const Form* form_;
    std::vector<OperandItem> items_;
    std::array<FieldPlace, 'z' - 'A' + 1> places_{};
};

/// One for every form, aliases included, in table order.
const std::vector<FormCodec>& codecs();

// Modes of Source and Destination operands.
inline constexpr std::uint32_t kModeDirect = 0;
inline constexpr std::uint32_t kModeIndirect = 1;
inline constexpr std::uint32_t kModePostDecrement = 2;
inline constexpr std::uint32_t kModePostIncrement = 3;
inline constexpr std::uint32_t kModePreDecrement = 4;
inline constexpr std::uint32_t kModePreIncrement = 5;
inline constexpr std::uint32_t kModeRegisterOffset = 6;  ///< 7 means the same

// Prefetch codes and write-back codes of the DSP class.
inline constexpr std::uint32_t kPrefetchNone = 4;
inline constexpr std::uint32_t kPrefetchOffset = 12;  ///< [W9+W12], [W11+W12]
inline constexpr std::uint32_t kWriteBackDirect = 0;
inline constexpr std::uint32_t kWriteBackIncrement = 1;
inline constexpr std::uint32_t kWriteBackNone = 2;
/// Pointer change in bytes of the low three code bits (4 excepted).
inline constexpr std::array<int, 8> kPrefetchStep{0, 2, 4, 6, 0, -6, -4, -2};
/// The two multiplicands of code m: W(4+first)*W(4+second).
inline constexpr std::array<std::array<int, 2>, 8> kProductPairs{
    {{4, 5}, {4, 6}, {4, 7}, {0, 0}, {5, 6}, {5, 7}, {6, 7}, {0, 0}}};

}  // namespace puckloop::dspic
