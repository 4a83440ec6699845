#pragma once
// Words to text, in the syntax of GNU as: lower case, "ldd r24, Y+1", numbers in hexadecimal, program
// addresses in bytes, absolute ones in branches too.
//
// A word that no form of this part covers, or a jump cut short, is written ".word 0x1234". The assembler
// takes every text back to the same words.

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

namespace puckloop::avr {

/// Names a byte address, or returns an empty string for "write the number".
using LabelOf = std::function<std::string(std::uint32_t address)>;

struct Disassembled {
    std::string text;
    int words = 1;
};

/// The instruction at byte address `address`; `next` is the word behind `word`, `has_next` false at the end.
Disassembled disassemble(std::uint16_t word, std::uint16_t next, bool has_next, std::uint32_t address,
                         const LabelOf& label_of = nullptr);

}  // namespace puckloop::avr
