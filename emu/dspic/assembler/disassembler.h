#pragma once
// Words to text, in the usual pic30 syntax: lower case, sizes spelled out (.b, .w), targets as addresses.
//
// The text names every word that the table defines. Where several words mean the same instruction, the one
// that an assembler would choose is written plainly and the others carry their ignored bits behind it in
// braces: "mov.w w0, w1 {w=3}", "nop {x=0x1234}". The assembler takes these back. A word that no form covers,
// or a two-word instruction whose second word is wrong, is written ".pword 0x3f1234".

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace puckloop::dspic {

/// The text of one instruction, without a line end, in place: fast, and no memory is allocated.
class InstructionText {
  public:
    std::string_view view() const { return {data_, size_}; }
    void clear() { size_ = 0; }
    void put(char c) { data_[size_++] = c; }
    void put(std::string_view text) {
        for (const char c : text)
            put(c);
    }
    void put_hex(std::uint32_t number);
    void put_decimal(int number);
    void pad_to(std::size_t column) {
        while (size_ < column)
            put(' ');
    }

  private:
    char data_[320];
    std::size_t size_ = 0;
};

/// Names a program address, or returns an empty view for "write the number". At most 128 characters are used.
using LabelOf = std::function<std::string_view(std::uint32_t address)>;

/// Appends the instruction at `address` to `text`. `next` is the word after it (0 if there is none). Returns
/// the number of words that it takes, 1 or 2.
int disassemble(std::uint32_t word, std::uint32_t next, std::uint32_t address, InstructionText& text,
                const LabelOf* label_of = nullptr);

/// The same as a string.
std::string disassemble(std::uint32_t word, std::uint32_t next = 0, std::uint32_t address = 0);

/// Number of words of the instruction that begins with `word`; 1 for an undefined word or a broken pair.
int length_of(std::uint32_t word, std::uint32_t next);

}  // namespace puckloop::dspic
