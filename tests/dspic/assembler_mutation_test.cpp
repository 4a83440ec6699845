// Seeded damage to a sound source: it assembles or is refused with an InputError, never anything else.
#include "base/error.h"
#include "base/random.h"
#include "emu/dspic/assembler/assembler.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;

namespace {

constexpr int kMutations = 4000;
const std::string kSource =
    "    .equ SIZE, (4*(3+1)-1)|0x10 ; comment\n"
    "start: mov.w #SIZE, w0\n    mac w4*w5, a, [w8]+=2, w4, [w11+w12], w5, [w13]+=2\n"
    "    mov [w14-2], w1 // comment\n    bra nz, start\n    do #5, last\n    nop {x=0x12}\n"
    "last: add w1, [++w2], [w3--]\n    call start\n    mov #tbloffset(text), w3\n"
    "    .org 0x200\ntext: .asciz \"a;\\\"b\\n\"\n    .pword 'A', -1, start>>1\n"
    "    .pfill 3, 0xffffff\n    sac.r b, #-3, [w1+w2]\n    ed w4*w4, a, [w9]-=6, [w10], w7\n";

}  // namespace

TEST_CASE("Damaged sources assemble or are refused") {
    RandomStream random(3, "assembler mutation");
    const std::string_view pieces = "#[]{}()+-*/<>=:;,.'\"\\ wWab0x9~|&%^$_\n\t";
    assemble(kSource);
    int refused = 0;
    for (int i = 0; i < kMutations; ++i) {
        std::string source = kSource;
        for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) {
            const auto at = static_cast<std::size_t>(random.below(source.size()));
            switch (random.below(4)) {
            case 0:
                source[at] = pieces[random.below(pieces.size())];
                break;
            case 1:
                source.insert(at, 1, pieces[random.below(pieces.size())]);
                break;
            case 2:
                source.erase(at, 1 + random.below(8));
                break;
            default:
                source[at] = static_cast<char>(random.below(256));
            }
        }
        try {
            assemble(source);
        } catch (const InputError& error) {
            ++refused;
            if (error.file() != "source" || error.place().empty()) FAIL("no place: " << error.what());
        }
    }
    CHECK(refused > kMutations / 2);
    CHECK(refused < kMutations);
}

TEST_CASE("Extreme sources are refused, not suffered") {
    CHECK_THROWS_AS(assemble(".pword " + std::string(100000, '(')), InputError);
    CHECK_THROWS_AS(assemble(".pword " + std::string(100000, '-')), InputError);
    CHECK_THROWS_AS(assemble(".pfill 100000000, 0"), InputError);
    CHECK_THROWS_AS(assemble("mov " + std::string(100000, ',')), InputError);
    CHECK_THROWS_AS(assemble(std::string(100000, 'x')), InputError);
    CHECK_THROWS_AS(assemble(".equ x, 0x7fffffff * 0x7fffffff * 4"), InputError);
}
