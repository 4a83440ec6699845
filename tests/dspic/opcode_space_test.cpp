// The whole opcode space: counted by form, fingerprinted, and taken through disassembler and assembler and
// back. The sanitizer build, ten times slower, looks at every 31st word only.

#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/assembler/encoder.h"
#include "emu/dspic/machine/isa.h"

#include <catch2/catch.hpp>

#include <map>
#include <string>
#include <utility>

using namespace puckloop::dspic;

namespace {

#ifdef __SANITIZE_ADDRESS__
constexpr std::uint32_t kStep = 31;
#else
constexpr std::uint32_t kStep = 1;
#endif
constexpr std::uint32_t kWords = 1u << 24;
constexpr std::uint64_t kDefined = 11669057;
constexpr std::uint64_t kUndefined = 5108159;
/// Sum over all defined words of a hash of (word, mnemonic, operands, length, cycles), from the same count
/// that opcode_counts.inc comes from.
constexpr std::uint64_t kFingerprint = 0x42354D2605F0A928;

const SymbolValue kNoSymbols = [](std::string_view) { return std::nullopt; };

using FormKey = std::pair<std::string_view, std::string_view>;

/// splitmix64's output function.
std::uint64_t mix(std::uint64_t z) {
    z += 0x9E3779B97F4A7C15;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
    z = (z ^ z >> 27) * 0x94D049BB133111EB;
    return z ^ z >> 31;
}

/// FNV-1a.
std::uint64_t hash_text(std::string_view text) {
    std::uint64_t hash = 0xCBF29CE484222325;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001B3;
    return hash;
}

/// A scattered but fixed choice, from `number`.
std::uint32_t scatter(std::uint32_t number) {
    return static_cast<std::uint32_t>(mix(number));
}

void check_round_trip(std::uint32_t word, std::uint32_t next, std::uint32_t address) {
    InstructionText text;
    const int length = disassemble(word, next, address, text);
    std::string problem = "other words came back";
    try {
        const Encoded back = encode(parse_instruction(text.view()), address, kNoSymbols);
        if (back.count == length && back.words[0] == word && (length == 1 || back.words[1] == next)) return;
    } catch (const std::exception& error) {
        problem = error.what();
    }
    FAIL(std::hex << word << " " << next << " at " << address << ": " << text.view() << ": " << problem);
}

}  // namespace

TEST_CASE("The opcode space has the counted forms and the known fingerprint") {
    const std::map<FormKey, std::uint64_t> expected = {
#define COUNT(mnemonic, operands, count) {{mnemonic, operands}, count},
#include "tests/dspic/opcode_counts.inc"
#undef COUNT
    };
    std::vector<std::uint64_t> counts(forms().size());
    std::vector<std::uint64_t> identity;
    for (const Form& form : forms())
        identity.push_back(hash_text(form.mnemonic) ^ mix(hash_text(form.operands)) ^
                           std::uint64_t{form.two_words() ? 2u : 1u} << 8 ^ form.cycles);
    std::uint64_t undefined = 0;
    std::uint64_t fingerprint = 0;
    for (std::uint32_t word = 0; word < kWords; word += kStep) {
        const Form* form = find_form(word);
        if (!form) {
            ++undefined;
            continue;
        }
        const auto index = static_cast<std::size_t>(form->id);
        ++counts[index];
        fingerprint += mix(word ^ mix(identity[index]));
    }
    if (kStep != 1) return;
    CHECK(undefined == kUndefined);
    CHECK(fingerprint == kFingerprint);
    std::uint64_t total = 0;
    for (const Form& form : forms()) {
        if (form.alias) continue;
        const auto found = expected.find({form.mnemonic, form.operands});
        INFO(form.name);
        REQUIRE(found != expected.end());
        CHECK(counts[static_cast<std::size_t>(form.id)] == found->second);
        total += found->second;
    }
    CHECK(total == kDefined);
}

TEST_CASE("assemble(disassemble(w)) == w for every defined word") {
    std::uint64_t count = 0;
    for (std::uint32_t word = 0; word < kWords; word += kStep) {
        const Form* form = find_form(word);
        if (!form) continue;
        ++count;
        check_round_trip(word, form->two_words() ? scatter(word) & 0x7F : 0, 0x1000);
    }
    CHECK((kStep != 1 || count == kDefined));
}

TEST_CASE("Two-word instructions survive with every first word and every second word") {
    for (const FormId id :
         {FormId::CALL_Expr, FormId::GOTO_Expr, FormId::DO_lit14_Expr, FormId::DO_Wn_Expr}) {
        const Form& form = puckloop::dspic::form(id);
        const std::uint32_t seconds = id == FormId::CALL_Expr || id == FormId::GOTO_Expr ? 0x80 : 0x10000;
        const std::uint32_t free_bits = ~form.mask & 0xFFFFFF;
        std::uint32_t bits = 0;
        do {
            const std::uint32_t word = form.value | bits;
            for (std::uint32_t i = 0; i < 4; ++i)
                check_round_trip(word, scatter(word + (i << 24)) % seconds, 0x2000);
            bits = (bits - free_bits) & free_bits;
        } while (bits != 0);
        for (std::uint32_t second = 0; second < seconds; ++second)
            for (std::uint32_t i = 0; i < 4; ++i)
                check_round_trip(form.value | (scatter(second + (i << 24)) & free_bits), second, 0x7FFFE0);
    }
}

TEST_CASE("Undefined words and broken pairs are written as data") {
    for (std::uint32_t word = 0; word < kWords; word += 97) {
        const Form* form = find_form(word);
        const std::uint32_t broken = 0xFF0000 | word;  // no second word has its upper byte set
        if (form && !form->two_words()) continue;
        InstructionText text;
        REQUIRE(disassemble(word, broken, 0, text) == 1);
        REQUIRE(text.view().starts_with(".pword"));
    }
}
