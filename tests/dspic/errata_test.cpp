// Errata of the 30F's revision B0 that can be switched on: what each changes, and nothing beside it.

#include "emu/dspic/devices/errata.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr auto D = PortLetter::D;
using Edges = std::vector<Pins30::Edge>;

Errata only(Erratum erratum) {
    Errata errata;
    errata.add(erratum);
    return errata;
}

/// DAW.B of every byte with every C and DC: results from `results` on, C of each from `carries` on.
std::string every_adjustment() {
    return R"(
        .org 0x200
        .equ results, 0x0a00
        .equ carries, 0x1000
main:   mov #results, w2
        mov #carries, w3
        clr w4                          ; C and DC
flags:  clr w1
byte:   mov w1, w0
        bclr SR, #0
        bclr SR, #8
        btsc w4, #0
        bset SR, #0
        btsc w4, #1
        bset SR, #8
        daw.b w0
        mov SR, w5
        mov.b w0, [w2++]
        mov.b w5, [w3++]
        inc w1, w1
        mov #256, w6
        cp w1, w6
        bra nz, byte
        inc w4, w4
        cp w4, #4
        bra nz, flags
done:   bra done
)";
}

std::string duties() {
    return R"(
        .org 0x200
main:   setm ADPCFG
        mov #99, w0
        mov w0, PR2
        mov #30, w0
        mov w0, OC1R
        mov w0, OC1RS
        mov #6, w0
        mov w0, OC1CON
        mov #0x8000, w0
        mov w0, T2CON
on:     repeat #120
        nop
        clr OC1RS                       ; from 200 on
        repeat #298
        nop
        mov #40, w0
        mov w0, OC1RS                   ; from 500 on
ready:  bra ready
)";
}

Edges edges_from(const std::string& source, Errata errata, Cycle& on) {
    Bench30 bench(source, {}, 0xFFE6, errata);
    on = bench.run_to("on");
    bench.go(on + 750);
    Edges edges = bench.edges(D, 0);
    edges.erase(edges.begin());  // high as soon as it is enabled
    return edges;
}

}  // namespace

TEST_CASE("daw.b: the carry that was set is lost where the sum carries nothing out, and nothing else") {
    Bench30 sound(every_adjustment());
    Bench30 erring(every_adjustment(), {}, 0xFFE6, only(Erratum::DawCarry));
    sound.run_to("done");
    erring.run_to("done");
    int lost = 0;
    for (int i = 0; i < 1024; ++i) {
        CAPTURE(i);
        const auto byte = [&](Bench30& bench, int address) {
            return bench.word(address & ~1) >> (address & 1 ? 8 : 0) & 0xFF;
        };
        const int before = byte(sound, 0x1000 + i), after = byte(erring, 0x1000 + i);
        CHECK(byte(sound, 0x0A00 + i) == byte(erring, 0x0A00 + i));
        CHECK((before & ~1) == (after & ~1));
        const int value = i & 0xFF, adjusted = value + ((value & 0xF) > 9 || (i & 0x200) ? 6 : 0);
        const bool had = (i & 0x100) != 0;
        const bool carries = adjusted > 0x9F;
        CHECK((before & 1) == (had || carries ? 1 : 0));
        CHECK((after & 1) == (carries ? 1 : 0));
        lost += before != after ? 1 : 0;
    }
    CHECK(lost > 100);
}

TEST_CASE("pwm-zero-duty: a pulse of a cycle when the duty becomes 0, then a period without its duty") {
    Cycle on = 0;
    const Edges sound = edges_from(duties(), {}, on);
    CHECK(sound == Edges{{on + 30, false},
                         {on + 100, true},
                         {on + 130, false},
                         {on + 500, true},
                         {on + 540, false},
                         {on + 600, true},
                         {on + 640, false},
                         {on + 700, true},
                         {on + 740, false}});
    const Edges erring = edges_from(duties(), only(Erratum::PwmZeroDuty), on);
    Edges expected = sound;
    expected.insert(expected.begin() + 3, {{on + 200, true}, {on + 201, false}});
    CHECK(erring == expected);
}

TEST_CASE("pwm-zero-duty: a duty that comes right behind 0 is missed for a period") {
    std::string source = duties();
    source.replace(source.find("#298"), 4, "#98 ");
    Cycle on = 0;
    const Edges sound = edges_from(source, {}, on);
    const Edges erring = edges_from(source, only(Erratum::PwmZeroDuty), on);
    REQUIRE(sound.size() > 6);
    CHECK(sound[3] == Pins30::Edge{on + 300, true});
    REQUIRE(erring.size() > 6);
    CHECK(erring[3] == Pins30::Edge{on + 200, true});
    CHECK(erring[4] == Pins30::Edge{on + 201, false});
    CHECK(erring[5] == Pins30::Edge{on + 400, true});
    CHECK(erring[6] == Pins30::Edge{on + 440, false});
}

TEST_CASE("errata have names, and another name is none") {
    for (const std::string_view name : kErratumNames)
        CHECK(name_of(*erratum_of(name)) == name);
    CHECK_FALSE(erratum_of("daw"));
    CHECK_FALSE(erratum_of(""));
}
