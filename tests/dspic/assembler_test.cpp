#include "base/error.h"
#include "emu/dspic/assembler/assembler.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::dspic;
using Words = std::vector<std::uint32_t>;

namespace {

std::string error_of(const std::string& source) {
    try {
        assemble(source);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

// Expected words from the pattern column of the instruction table (programmer's reference).
TEST_CASE("Instructions of every shape") {
    CHECK(assemble_words("mov.w #0x1234, w5") == Words{0x212345});
    CHECK(assemble_words("MOV #-1,W0") == Words{0x2FFFF0});
    CHECK(assemble_words("mov.b #0x80, w3") == Words{0xB3C803});
    CHECK(assemble_words("mov w1, [w2++]") == Words{0x781901});
    CHECK(assemble_words("mov.b [w3+w4], [--w5]") == Words{0x7A62E3});
    CHECK(assemble_words("mov [w14+2], w1") == Words{0x90009E});
    CHECK(assemble_words("mov w0, [w14-2]") == Words{0x9FBF70});
    CHECK(assemble_words("mov 0x800, w0") == Words{0x804000});
    CHECK(assemble_words("mov w0, 0xfffe") == Words{0x8FFFF0});
    CHECK(assemble_words("mov.b wreg, 0x123") == Words{0xB7E123});
    CHECK(assemble_words("mov 0x100, wreg") == Words{0xBF8100});
    CHECK(assemble_words("add w1, w2, w3") == Words{0x408182});
    CHECK(assemble_words("add w1, #31, [w3]") == Words{0x4089FF});
    CHECK(assemble_words("add #1023, w4") == Words{0xB03FF4});
    CHECK(assemble_words("add.b 0x20, wreg") == Words{0xB44020});
    CHECK(assemble_words("bset 0x2c6, #13") == Words{0xA8A2C7});
    CHECK(assemble_words("bset.b 0x2c7, #5") == Words{0xA8A2C7});
    CHECK(assemble_words("btst w2, #4") == Words{0xA34802});
    CHECK(assemble_words("lnk #4") == Words{0xFA0004});
    CHECK(assemble_words("div.sw w4, w3") == Words{0xD80203});
    CHECK(assemble_words("div.ud w4, w3") == Words{0xD8AA43});
    CHECK(assemble_words("mul.uu w1, w2, w4") == Words{0xB80A02});
    CHECK(assemble_words("push w0") == assemble_words("mov w0, [w15++]"));
    CHECK(assemble_words("pop w0") == assemble_words("mov [--w15], w0"));
    CHECK(assemble_words("push.d w8") == Words{0xBE9F88});
    CHECK(assemble_words("pop.d w8") == Words{0xBE044F});
    CHECK(assemble_words("push 0x36") == Words{0xF80036});
    CHECK(assemble_words("retlw #5, w0") == Words{0x050050});
    CHECK(assemble_words("mac w4*w5, a, [w8]+=2, w4, [w10]+=2, w5, w13") == Words{0xC00444});
    CHECK(assemble_words("clr b") == Words{0xC38112});
    CHECK(assemble_words("ed w4*w4, a, [w8]+=2, [w10]-=2, w5") == Words{0xF0505F});
    CHECK(assemble_words("sac.r a, #-3, w1") == Words{0xCD0681});
    CHECK(assemble_words("sftac b, #-16") == Words{0xC88070});
    CHECK(assemble_words("repeat #17") == Words{0x090011});
    CHECK(assemble_words("nop\nnopr") == Words{0x000000, 0xFF0000});
}

TEST_CASE("Branches, calls and loops reach their labels") {
    CHECK(assemble_words("x: bra x") == Words{0x37FFFF});
    CHECK(assemble_words("bra nz, x\nnop\nx: nop") == Words{0x3A0001, 0, 0});
    CHECK(assemble_words("x: nop\nbra geu, x") == assemble_words("x: nop\nbra c, x"));
    CHECK(assemble_words("x: nop\nbra ltu, x") == assemble_words("x: nop\nbra nc, x"));
    CHECK(assemble_words("goto 0x12344") == Words{0x042344, 0x000001});
    CHECK(assemble_words("call x\nx: nop", 0x10000) == Words{0x020004, 0x000001, 0});
    CHECK(assemble_words("do #9, last\nnop\nlast: nop") == Words{0x080009, 0x000001, 0, 0});
    CHECK(assemble_words("do w3, .+6\nnop\nnop") == Words{0x088003, 0x000001, 0, 0});
    CHECK(assemble_words("call w2\ngoto w3\nbra w4\nrcall w5") ==
          Words{0x010002, 0x014003, 0x016004, 0x012005});
}

TEST_CASE("Directives and expressions") {
    const Program program =
        assemble("    .equ SIZE, 4*(3+1) ; comment\n"
                 "MASK = ~0xF0 & 0xFF     // comment\n"
                 "LATE = end - start\n"
                 "    .text\n    .global start\n    .org 0x100\n"
                 "start: mov #SIZE, w0\n    mov.b #MASK, w1\n    mov #LATE, w2\n"
                 "    mov #tbloffset(table), w3\n    mov #tblpage(table), w4\n"
                 "    mov.b #';', w5\nend:\n"
                 "    .org 0x12000\ntable: .pword 0xabcdef, 1|2, 'A'<<8\n"
                 "    .word -1, end\n    .asciz \"a;b\\n\"\n    .pfill 2, 0xffffff\n    .end\n junk");
    CHECK(program.symbol("start") == 0x100);
    CHECK(program.words.at(0x100) == 0x200100);
    CHECK(program.words.at(0x102) == 0xB3C0F1);
    CHECK(program.words.at(0x104) == 0x2000C2);
    CHECK(program.words.at(0x106) == 0x220003);
    CHECK(program.words.at(0x108) == 0x200014);
    CHECK(program.words.at(0x10A) == 0xB3C3B5);
    CHECK(program.words.at(0x12000) == 0xABCDEF);
    CHECK(program.words.at(0x12002) == 3);
    CHECK(program.words.at(0x12004) == 0x4100);
    CHECK(program.words.at(0x12006) == 0xFFFF);
    CHECK(program.words.at(0x12008) == 0x10C);
    CHECK(program.words.at(0x1200A) == 0x3B61);
    CHECK(program.words.at(0x1200E) == 0);
    CHECK(program.words.at(0x12010) == 0xFFFFFF);
    CHECK(program.words.rbegin()->first == 0x12012);
}

TEST_CASE("Errors name line, problem and what would do") {
    CHECK(error_of("nop\n ad w0, w1, w2") == "source: line 2: unknown instruction \"ad\" (expected add?)");
    CHECK(error_of("mov.w w0") == "source: line 1: mov.w does not take these operands (expected WREG,f or f "
                                  "or f,WREG or #lit16,Wnd or Ws,Wd "
                                  "or f,Wnd or Wns,f or [Ws+Slit10],Wnd or Wns,[Wd+Slit10])");
    CHECK(error_of("mov #0x10000, w0") == "source: line 1: the literal 65536 is outside -32768 to 65535");
    CHECK(error_of("bra Main\nmain: nop") == "source: line 1: unknown name \"Main\" (expected main?)");
    CHECK(error_of("start: nop\nbra strt") == "source: line 2: unknown name \"strt\" (expected start?)");
    CHECK(error_of("bra xyz, 0").find("unknown condition \"xyz\" (expected ov c z") != std::string::npos);
    CHECK(error_of("x: nop\nx: nop") == "source: line 2: \"x\" is defined twice (expected each label once)");
    CHECK(error_of("w3: nop").find("is a register's name") != std::string::npos);
    CHECK(error_of("bra 0x20002").find("can be reached") != std::string::npos);
    CHECK(error_of("goto 0x101") == "source: line 1: the target 0x101 is odd");
    CHECK(error_of("mov [w0+1], w1") == "source: line 1: the offset 0x1 is odd");
    CHECK(error_of("mov 0x801, w1") == "source: line 1: the word address 0x801 is odd");
    CHECK(error_of("mul.uu w0, w1, w3").find("d even") != std::string::npos);
    CHECK(error_of("mov [w1+w2], [w3+w4]").find("share one offset register") != std::string::npos);
    CHECK(error_of("nop\n.org 0\nnop").find("already holds a word (expected another .org)") !=
          std::string::npos);
    CHECK(error_of("mov #1/0, w0") == "source: line 1: division by zero");
    CHECK(error_of(".pword (1").find("')' is missing") != std::string::npos);
    CHECK(error_of(".org 0x101").find("an even program address") != std::string::npos);
    CHECK(error_of(".pword 0x1000000").find("does not fit") != std::string::npos);
    CHECK(error_of(".foo") ==
          "source: line 1: unknown directive \".foo\" (expected .org .equ .pword .word .pfill "
          ".ascii .asciz .text .global .include .end)");
    CHECK(error_of("mov w0, w1,").find("after the last comma") != std::string::npos);
    CHECK(error_of(".include \"no_such_file.s\"").find("cannot read no_such_file.s") != std::string::npos);
    CHECK(error_of("mov [w0, w1").find("cannot read the address") != std::string::npos);
}

TEST_CASE("Included files are read beside the one that names them") {
    namespace fs = std::filesystem;
    const fs::path folder = puckloop::tests::scratch_path("puckloop_include_test");
    fs::create_directories(folder);
    std::ofstream(folder / "part.s") << "mov #1, w0\nbad\n";
    AssembleOptions options;
    options.file = (folder / "main.s").string();
    try {
        assemble("nop\n.include \"part.s\"\n", options);
        FAIL("no error");
    } catch (const InputError& error) {
        CHECK(error.file() == (folder / "part.s").string());
        CHECK(error.place() == "line 2");
    }
    std::ofstream(folder / "loop.s") << ".include \"loop.s\"\n";
    CHECK_THROWS_AS(assemble(".include \"loop.s\"", options), InputError);
    fs::remove_all(folder);
}

TEST_CASE("Predefined names and kept lines") {
    AssembleOptions options;
    options.predefined["PORTA"] = 0x2C2;
    options.keep_lines = true;
    const Program program = assemble("mov PORTA, w0\ncall 0x100\n", options);
    CHECK(program.words.at(0) == 0x801610);
    REQUIRE(program.lines.size() == 2);
    CHECK(program.lines[1].address == 2);
    CHECK(program.lines[1].words == 2);
    CHECK(program.lines[1].line == 2);
}
