#pragma once
// A whole program as assembler source: labels, instructions, address and words as comment. What it writes,
// the assembler turns back into the same words.

#include <cstdint>
#include <map>
#include <string>

namespace puckloop::dspic {

struct ListingOptions {
    std::uint32_t start = 0;            ///< first program address, even
    std::uint32_t end = 0xFFFFFE;       ///< last one
    std::uint32_t vectors_end = 0x100;  ///< words from 4 up to here are vectors, not instructions
    /// Names by program address; those that no assembler would take are left out.
    std::multimap<std::uint32_t, std::string> labels;
};

/// `words` by even program address. Branch targets without a name become L_123456. Words in data EEPROM and
/// configuration space, constants and vectors are written as .pword, equal words in a row as .pfill.
std::string list_program(const std::map<std::uint32_t, std::uint32_t>& words,
                         const ListingOptions& options = {});

}  // namespace puckloop::dspic
