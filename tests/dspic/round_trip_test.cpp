// The whole opcode space: counted, fingerprinted, and taken through disassembler and assembler.
#include "emu/dspic/assembler/codec.h"
#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/assembler/encoder.h"
#include "emu/dspic/isa.h"

#include <catch2/catch.hpp>

#include <map>

using namespace puckloop::dspic;

namespace {

constexpr std::uint32_t kWords = 1u << 24;
const SymbolValue kNoSymbols = [](std::string_view) { return std::nullopt; };

/// True when the text of the words assembles to the same words.
bool survives(std::uint32_t word, std::uint32_t next, std::uint32_t address) {
    InstructionText text;
    const int length = disassemble(word, next, address, text);
    const Encoded encoded = encode(parse_instruction(text.view()), address, kNoSymbols);
    const bool same =
        encoded.count == length && encoded.words[0] == word && (length == 1 || encoded.words[1] == next);
    if (!same) UNSCOPED_INFO("word " << std::hex << word << " next " << next << ": " << text.view());
    return same;
}

void round_trip(std::uint32_t first, std::uint32_t step) {
    std::uint64_t count = 0;
    for (std::uint32_t word = first; word < kWords; word += step) {
        const Form* form = find_form(word);
        if (!form) continue;
        ++count;
        const std::uint32_t next = form->two_words() ? (word * 2654435761u >> 9 & 0x7F) : 0;
        bool same = false;
        try {
            same = survives(word, next, 0x1000);
        } catch (const std::exception& error) {
            FAIL("word " << std::hex << word << ": " << disassemble(word, next, 0x1000) << ": "
                         << error.what());
        }
        if (!same) FAIL("word " << std::hex << word << ": " << disassemble(word, next, 0x1000));
    }
    CHECK(count > 0);
    if (step == 1) CHECK(count == 11669057);
}

}  // namespace

TEST_CASE("assemble(disassemble(w)) == w for a slice of the opcode space") {
    round_trip(0, 251);
}

TEST_CASE("assemble(disassemble(w)) == w for every defined word", "[slow]") {
    round_trip(0, 1);
}
