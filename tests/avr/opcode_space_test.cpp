// The whole opcode space: counted per form, and taken through disassembler and assembler and back.

#include "emu/avr/assembler/disassembler.h"
#include "emu/avr/assembler/encoder.h"
#include "emu/avr/isa/isa.h"

#include <catch2/catch.hpp>

#include <map>
#include <string>

using namespace puckloop::avr;

namespace {

const puckloop::assembly::SymbolValue kNoSymbols = [](std::string_view) { return std::nullopt; };

/// Second words that meet every bit.
constexpr std::uint16_t kSecondWords[] = {0x0000, 0xFFFF, 0x5555, 0xAAAA, 0x0060, 0x1234, 0x8001};

void check_round_trip(std::uint16_t word, std::uint16_t next, std::uint32_t address) {
    const Disassembled instruction = disassemble(word, next, true, address);
    std::string problem = "other words came back";
    try {
        const Encoded back = encode(instruction.text, address, kNoSymbols);
        if (back.count == instruction.words && back.words[0] == word &&
            (back.count == 1 || back.words[1] == next))
            return;
    } catch (const std::exception& error) {
        problem = error.what();
    }
    FAIL(std::hex << word << " " << next << " at " << address << ": " << instruction.text << ": " << problem);
}

}  // namespace

TEST_CASE("Every form has the counted number of words") {
    const std::map<std::string_view, int> expected = {
#define COUNT(form, words) {#form, words},
#include "tests/avr/opcode_counts.inc"
#undef COUNT
    };
    std::map<std::string_view, int> counts;
    int undefined = 0;
    for (std::uint32_t word = 0; word < 0x10000; ++word) {
        const Form* form = find_form(static_cast<std::uint16_t>(word));
        if (form)
            ++counts[form->name];
        else
            ++undefined;
    }
    CHECK(counts.size() == 89);
    CHECK(undefined == 1701);
    for (const auto& [name, count] : expected) {
        INFO(name);
        CHECK(counts[name] == count);
    }
    CHECK(counts.size() == expected.size());
}

TEST_CASE("encode(disassemble(w)) == w for every word, second words included") {
    int defined = 0;
    for (std::uint32_t first = 0; first < 0x10000; ++first) {
        const auto word = static_cast<std::uint16_t>(first);
        const Form* form = find_form(word);
        if (!form) {
            CHECK(disassemble(word, 0, true, 0).text.starts_with(".word 0x"));
            continue;
        }
        ++defined;
        for (const std::uint16_t next : kSecondWords)
            check_round_trip(word, next, (first * 2) % kProgramBytes);
        if (!form->two_words) continue;
        CHECK(disassemble(word, 0, false, 0).text.starts_with(".word 0x"));
    }
    CHECK(defined == 0x10000 - 1701);
    for (const FormId id : {FormId::JMP, FormId::CALL, FormId::LDS, FormId::STS})
        for (std::uint32_t next = 0; next < 0x10000; ++next)
            check_round_trip(form(id).pattern.value(), static_cast<std::uint16_t>(next), 0);
}

TEST_CASE("Branches reach around both ends of the program memory") {
    check_round_trip(0xCFFF, 0, 0);        // rjmp back to itself
    check_round_trip(0xC7FF, 0, 0x1FFFE);  // forward over the end
    check_round_trip(0xC800, 0, 0);        // backward over the start
    CHECK(disassemble(0xC000, 0, true, 0x1FFFE).text == "rjmp 0x0");
}

TEST_CASE("The spelling is the one of GNU as") {
    const auto text = [](std::uint16_t word, std::uint16_t next = 0) {
        return disassemble(word, next, true, 0x100).text;
    };
    CHECK(text(0x0C01) == "add r0, r1");
    CHECK(text(0xE1F2) == "ldi r31, 0x12");
    CHECK(text(0x9478) == "sei");
    CHECK(text(0xF7F1) == "brne 0xfe");
    CHECK(text(0x8108) == "ld r16, Y");
    CHECK(text(0x8189) == "ldd r24, Y+1");
    CHECK(text(0x9180, 0x00C6) == "lds r24, 0x00c6");
    CHECK(text(0x940E, 0x0ABC) == "call 0x1578");
    CHECK(text(0x01CF) == "movw r24, r30");
    CHECK(text(0x9607) == "adiw r24, 0x07");
    CHECK(text(0x9A2D) == "sbi 0x05, 5");
    CHECK(text(0x95C8) == "lpm");
    CHECK(text(0x9519) == ".word 0x9519");  // EICALL: not on a part with a 16-bit program counter
}
