// Programs to source text and back.
#include "base/random.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/assembler/disassembler.h"
#include "emu/dspic/assembler/listing.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;

TEST_CASE("Disassembled text is the usual syntax") {
    CHECK(disassemble(0xFA0004) == "lnk       #0x4");
    CHECK(disassemble(0x90009E) == "mov.w     [w14+2], w1");
    CHECK(disassemble(0x36FFF9, 0, 0x2E8) == "bra       leu, 0x2dc");
    CHECK(disassemble(0x508F80) == "sub.w     w1, w0, [w15]");
    CHECK(disassemble(0x040100, 0x000001) == "goto      0x10100");
    CHECK(disassemble(0x040100, 0x000080) == ".pword    0x40100");
    CHECK(disassemble(0x3F1234) == ".pword    0x3f1234");
    CHECK(disassemble(0xC00444) == "mac       w4*w5, a, [w8]+=2, w4, [w10]+=2, w5, w13");
    CHECK(disassemble(0xA8A2C7) == "bset.b    0x2c7, #0x5");
    CHECK(disassemble(0x001234) == "nop {x=0x1234}");
    CHECK(disassemble(0x000000) == "nop");
    CHECK(disassemble(0xCD0681) == "sac.r     a, #-3, w1");
    CHECK(disassemble(0xBE9F88) == "mov.d     w8, [w15++]");
}

TEST_CASE("A listing shows labels, targets, addresses, data and gaps") {
    const Program program = assemble("goto start\n.pword handler, 0x100\n.org 0x100\nstart: mov #1, w0\n"
                                     "loop: dec w0, w0\nbra nz, loop\ncall handler\nbra start\n"
                                     "handler: retfie\n.pfill 9, 0xffffff\n.org 0xf80000\n.pword 0xc706\n");
    ListingOptions options;
    options.labels = {{0x100, "_main"}, {0x100, "bad name"}, {0x10C, "__T1Interrupt"}, {0x10C, "w4"}};
    const std::string text = list_program(program.words, options);
    CHECK(text == "        goto      _main                         ; 000000: 040100 000000\n"
                  "        .pword    __T1Interrupt                 ; 000004: 00010c\n"
                  "        .pword    _main                         ; 000006: 000100\n"
                  "\n        .org      0x100\n"
                  "_main:\n"
                  "        mov.w     #0x1, w0                      ; 000100: 200010\n"
                  "L_000102:\n"
                  "        dec.w     w0, w0                        ; 000102: e90000\n"
                  "        bra       nz, L_000102                  ; 000104: 3afffe\n"
                  "        call      __T1Interrupt                 ; 000106: 02010c 000000\n"
                  "        bra       _main                         ; 00010a: 37fffa\n"
                  "__T1Interrupt:\n"
                  "        retfie                                  ; 00010c: 064000\n"
                  "        .pfill    9, 0xffffff                   ; 00010e: ffffff\n"
                  "\n        .org      0xf80000\n"
                  "        .pword    0xc706                        ; f80000: 00c706\n");
    CHECK(assemble(text).words == program.words);
}

TEST_CASE("Programs of random words survive listing and assembling") {
    RandomStream random(7, "listing");
    for (int round = 0; round < 20; ++round) {
        std::map<std::uint32_t, std::uint32_t> words;
        std::uint32_t address = 0;
        for (int i = 0; i < 2000; ++i) {
            std::uint32_t word = static_cast<std::uint32_t>(random.next()) & 0xFFFFFF;
            if (random.below(4) == 0) word &= 0xFF00FF & 0x0FFFFF;  // more calls, loops and no-operations
            words[address] = word;
            address += random.below(50) == 0 ? 2 * static_cast<std::uint32_t>(random.below(90)) + 4 : 2;
        }
        words[0x7FF000] = 0x1234;
        words[0xF80002] = 0xFF;
        REQUIRE(assemble(list_program(words)).words == words);
    }
}
