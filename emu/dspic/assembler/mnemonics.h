#pragma once
// Mnemonics as they are written, with their size suffixes and second spellings, and the forms each may mean.

#include "emu/dspic/assembler/codec.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::dspic {

struct Candidate {
    const FormCodec* codec = nullptr;
    int byte = -1;  ///< 1 byte operation, 0 word operation, -1 the form has no size
};

/// Null if unknown. "add" and "add.w" are words, "add.b" bytes; any case.
const std::vector<Candidate>* find_mnemonic(std::string_view name);

/// The conditional branch for "nz", "geu" ...; null if unknown.
const std::vector<Candidate>* find_condition(std::string_view name);

/// The known mnemonic closest to a misspelt one; empty if none is near.
std::string nearest_mnemonic(std::string_view name);

}  // namespace puckloop::dspic
