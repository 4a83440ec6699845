// The AVR assembler: labels, directives, messages; and listings that come back as the same bytes.

#include "base/error.h"
#include "base/random.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/avr/assembler/listing.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop;
using namespace puckloop::avr;
using Catch::Contains;

namespace {

Program build(const std::string& source) {
    return assemble(source, {"x.s", &atmega1284p(), false});
}
std::string error_of(const std::string& source) {
    try {
        build(source);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("labels, registers of the chip and directives") {
    const Program program = build(R"(
        SIZE = 4*8
start:  ldi   r24, lo8(table)      ; comment
        ldi   r25, hi8(table)
        lds   r16, UDR0
        out   SREG, r0
        ldd   r2, Y + 3
        st    -X, r5
        rjmp  start
        sbr   r16, 0x81
        cbr   r16, 0x81
        lsl   r3
        breq  start
table:  .word 0x1234, SIZE
        .byte 1, -1
        .asciz "ok\n"
        .balign 2
        nop
)");
    CHECK(program.word(0) == 0xE188);
    CHECK(program.word(4) == 0x9100);
    CHECK(program.word(6) == 0x00C6);
    CHECK(program.word(8) == 0xBE0F);
    CHECK(program.word(10) == 0x802B);
    CHECK(program.word(12) == 0x925E);
    CHECK(program.word(14) == 0xCFF8);
    CHECK(program.word(16) == 0x6801);
    CHECK(program.word(18) == 0x770E);
    CHECK(program.word(20) == 0x0C33);
    CHECK(program.word(22) == 0xF3A1);
    CHECK(program.symbol("table") == 24);
    CHECK(program.word(24) == 0x1234);
    CHECK(program.word(26) == 32);
    CHECK(program.word(28) == 0xFF01);
    CHECK(program.word(34) == 0x0000);
}

TEST_CASE("a mistake is named with its line and what was expected") {
    CHECK_THAT(error_of("nop\nldi r3, 1"),
               Contains("x.s: line 2: r3 cannot be used here (expected r16 to r31)"));
    CHECK_THAT(error_of("lid r16, 1"), Contains("unknown instruction \"lid\" (expected ldi?)"));
    CHECK_THAT(error_of("ldi r16, 256"), Contains("256 does not fit"));
    CHECK_THAT(error_of("ldd r0, X+1"), Contains("do not fit (expected ldd Rd,Y+q or ldd Rd,Z+q)"));
    CHECK_THAT(error_of("ldd r0, Y+64"), Contains("displacement 64 does not fit (expected 0 to 63)"));
    CHECK_THAT(error_of("rjmp 0x4000"), Contains("words away (expected -2048 to 2047)"));
    CHECK_THAT(error_of("rjmp 3"), Contains("target 0x3 is odd"));
    CHECK_THAT(error_of("movw r1, r2"), Contains("an even register from r0 to r30"));
    CHECK_THAT(error_of("sbi UDR0, 1"), Contains("I/O address 198 does not fit (expected 0 to 31)"));
    CHECK_THAT(error_of("a: nop\na: nop"), Contains("\"a\" is defined twice"));
    CHECK_THAT(error_of("jmp nowhere"), Contains("unknown name \"nowhere\""));
    CHECK_THAT(error_of(".org 0x20000"), Contains(".org 0x20000"));
    CHECK_THAT(error_of("nop\n.org 0\nnop"), Contains("already holds a byte"));
}

TEST_CASE("a listing of any bytes assembles to the same bytes") {
    RandomStream random(3, "avr listing");
    for (int round = 0; round < 40; ++round) {
        std::vector<image::ByteSegment> segments;
        std::uint64_t at = random.below(64);
        for (int i = 0; i < 3; ++i) {
            image::ByteSegment segment{at, {}};
            for (std::uint64_t n = 1 + random.below(300); n > 0; --n)
                segment.bytes.push_back(static_cast<std::uint8_t>(random.below(256)));
            at = segment.end() + 1 + random.below(1000);
            segments.push_back(segment);
        }
        ListingOptions options;
        options.labels.emplace(segments[1].address & ~1u, "middle");
        const std::string text = list_program(segments, options);
        const Program back = build(text);
        std::map<std::uint32_t, std::uint8_t> expected;
        for (const image::ByteSegment& segment : segments)
            for (std::size_t i = 0; i < segment.bytes.size(); ++i)
                expected[static_cast<std::uint32_t>(segment.address + i)] = segment.bytes[i];
        INFO(text);
        REQUIRE(back.bytes == expected);
    }
}
