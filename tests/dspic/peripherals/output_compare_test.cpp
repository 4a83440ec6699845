// OC1 to OC8 of the 30F: edges at the pin and their interrupts to the cycle, PWM, fault inputs.

#include "base/random.h"
#include "emu/dspic/machine/interrupts.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr auto B = PortLetter::B;
constexpr auto D = PortLetter::D;
using Edges = std::vector<Pins30::Edge>;

struct Compare {
    int con = 0, r = 0, rs = 0, period = 0;
};

/// OC1 and OC5 alike on Timer2, which is switched on last and counts from cycle `on` on.
struct CompareBench : Bench30 {
    Cycle on = 0;

    explicit CompareBench(const Compare& compare, const std::string& more = {}, int t2con = 0x8000)
        : Bench30(source(compare, more, t2con)) {
        on = run_to("on");
        run_to("ready");
    }
    static std::string source(const Compare& compare, const std::string& more, int t2con) {
        const auto load = [](int value, const std::string& name) {
            return "        mov #" + std::to_string(value) + ", w0\n        mov w0, " + name + "\n";
        };
        std::string text = "        .org 0x200\nmain:\n        setm ADPCFG\n" + load(compare.period, "PR2");
        for (const char* unit : {"OC1", "OC5"}) {
            const std::string name = unit;
            text +=
                load(compare.r, name + "R") + load(compare.rs, name + "RS") + load(compare.con, name + "CON");
        }
        return text + load(t2con, "T2CON") + "on:\n" + more +
               "ready:  repeat #0x3ff\n        nop\n        bra ready\n";
    }
    /// First cycle from `from` on with the interrupt flag of OC1 set; it is cleared again.
    Cycle flag(Cycle from, Cycle last) {
        for (Cycle cycle = from; cycle <= last; ++cycle) {
            go(cycle + 1);
            if (!(reg("IFS0") & 4)) continue;
            chip.inside().interrupts.clear(2);
            return cycle;
        }
        return kNoCycle;
    }
};

}  // namespace

TEST_CASE("single compare: the pin one cycle after the match, OCxIF two after that (DS70061 14.3.1)") {
    RandomStream random(5, "compare");
    for (const int mode : {1, 2}) {
        const int r = 30 + static_cast<int>(random.below(900));
        CompareBench bench({mode, r, 0, 1000});
        const Cycle match = bench.on + static_cast<Cycle>(r);
        CHECK(bench.flag(bench.chip.cycle(), match + 2000) == match + 3);
        REQUIRE_FALSE(bench.edges(D, 0).empty());
        CHECK(bench.edges(D, 0).back() == Pins30::Edge{match + 1, mode == 1});
        CHECK(bench.edges(D, 0).size() == (mode == 1 ? 1 : 2));  // low rests at first, high is set at once
        CHECK(bench.edges(D, 4).back() == bench.edges(D, 0).back());
        CHECK(bench.flag(bench.chip.cycle(), match + 4000) == kNoCycle);  // one shot
    }
}

TEST_CASE("toggle begins low and turns at every match, with the timer's prescaler (DS70061 14.3.1.3)") {
    CompareBench bench({3, 40, 0, 99}, {}, 0x8010);
    bench.go(bench.on + 8 * 500);
    Edges expected;
    for (Cycle i = 0; i < 5; ++i)
        expected.push_back({bench.on + 8 * (40 + 100 * i) + 1, i % 2 == 0});
    CHECK(bench.edges(D, 0) == expected);
}

TEST_CASE("toggle keeps the level of the mode before") {
    CompareBench bench({2, 40, 0, 99}, "        mov #3, w0\n        mov w0, OC1CON\n");
    bench.go(bench.on + 60);
    CHECK(bench.edges(D, 0).back() == Pins30::Edge{bench.on + 41, false});
    CHECK(bench.edges(D, 0).size() == 2);
}

TEST_CASE("a single pulse is high from OCxR to OCxRS, comes once, and again by writing the mode") {
    CompareBench bench({4, 40, 70, 99}, R"(
again:  repeat #300
        nop
        mov #4, w0
        mov w0, OC1CON
written:
)");
    const Cycle written = bench.chip.cycle();  // "ready" is where "written" is
    bench.go(written + 250);
    REQUIRE(bench.edges(D, 0).size() == 4);
    CHECK(bench.edges(D, 0)[0] == Pins30::Edge{bench.on + 41, true});
    CHECK(bench.edges(D, 0)[1] == Pins30::Edge{bench.on + 71, false});
    CHECK(bench.edges(D, 0)[2] == Pins30::Edge{bench.on + 341, true});
    CHECK(bench.edges(D, 0)[3] == Pins30::Edge{bench.on + 371, false});
    CHECK(bench.edges(D, 4).size() == 2);
}

TEST_CASE("continuous pulses interrupt at their falling edge") {
    CompareBench bench({5, 40, 70, 99});
    CHECK(bench.flag(bench.chip.cycle(), bench.on + 99) == bench.on + 73);
    CHECK(bench.flag(bench.chip.cycle(), bench.on + 199) == bench.on + 173);
    Edges expected;
    for (Cycle i = 0; i < 2; ++i) {
        expected.push_back({bench.on + 100 * i + 41, true});
        expected.push_back({bench.on + 100 * i + 71, false});
    }
    CHECK(bench.edges(D, 0) == expected);
}

TEST_CASE("PWM: duty from OCxRS at each period, 0 and beyond PRy stay low and high (DS70061 14.3.3)") {
    CompareBench bench({6, 30, 30, 99}, R"(
        repeat #120
        nop
        mov #60, w0
        mov w0, OC1RS
        repeat #98
        nop
        clr OC1RS
        repeat #98
        nop
        setm OC1RS
        repeat #198
        nop
        mov #10, w0
        mov w0, OC1RS
        mov OC1R, w5
        mov w5, OC1R                    ; read only
)");
    bench.go(bench.on + 1000);
    const Cycle on = bench.on;
    Edges edges = bench.edges(D, 0);
    REQUIRE(edges.size() > 9);
    edges.erase(edges.begin());  // high as soon as it is enabled, for OCxR is not 0
    const Edges expected{{on + 30, false},  {on + 100, true}, {on + 130, false}, {on + 200, true},
                         {on + 260, false}, {on + 400, true},  // 0 % from 300 on, more than PR2 from 400 on
                         {on + 610, false}, {on + 700, true}, {on + 710, false}};
    CHECK(Edges(edges.begin(), edges.begin() + 9) == expected);
    CHECK_FALSE(bench.reg("IFS0") & 4);  // TyIF is the period's interrupt
}

TEST_CASE("a mode with faults, written while OCFA and OCFB are low, is off at once (DS70061 14.3.3.1)") {
    CompareBench bench({7, 30, 30, 99});
    CHECK(bench.reg("OC1CON") == 0x17);
    CHECK(bench.reg("OC5CON") == 0x17);
    CHECK((bench.pins.driven_now[3] & 0x11) == 0);
    CHECK((bench.reg("IFS0") & 4) == 4);
    CHECK((bench.reg("IFS2") & 1) == 1);
}

TEST_CASE("OCFA stops OC1 at once, OC5 goes on, only with OCFA high again does writing the mode help") {
    const std::string source = CompareBench::source({7, 30, 30, 99}, R"(
loop:   btss PORTF, #0
        bra loop
        mov #7, w0
        mov w0, OC1CON
        bra loop
)",
                                                    0x8000);
    Bench30 bench(source);
    bench.pins.outside[1] = 0xFFFF;
    const Cycle on = bench.run_to("on");
    bench.set(B, 6, false, on + 1015);
    bench.go(on + 1016);
    CHECK(bench.reg("OC1CON") == 0x17);
    CHECK(bench.reg("OC5CON") == 0x07);
    CHECK((bench.pins.driven_now[3] & 0x11) == 0x10);
    CHECK((bench.reg("IFS0") & 4) == 4);
    bench.set(PortLetter::F, 0, true, on + 1500);  // the program writes the mode again and again
    bench.go(on + 1700);
    CHECK(bench.reg("OC1CON") == 0x17);
    bench.set(B, 6, true, on + 2015);
    bench.go(on + 2100);
    CHECK(bench.reg("OC1CON") == 0x07);
    bench.go(on + 2205);
    CHECK((bench.pins.driven_now[3] & 0x11) == 0x11);
    CHECK(bench.edges(D, 0).back() == Pins30::Edge{on + 2200, true});
    CHECK(bench.edges(D, 4).back() == Pins30::Edge{on + 2200, true});
}

TEST_CASE("a board that wants no edges of PWM hears of period and duty, and a saved state goes on") {
    const std::string source = CompareBench::source({6, 30, 30, 99}, {}, 0x8000);
    Bench30 quiet(source);
    quiet.pins.pwm_edges = false;
    quiet.go(2000);
    CHECK(quiet.edges(D, 0).empty());
    CHECK(quiet.chip.output_compare(1) == OutputCompareState{6, true, 100, 30, false});

    Bench30 first(source), second(source);
    first.go(1234);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    first.chip.state(writer);
    StateReader reader(bytes);
    second.chip.state(reader);
    second.pins.levels_now = first.pins.levels_now;
    const std::size_t before = first.edges(D, 0).size();
    first.go(2345);
    second.go(2345);
    CHECK(Edges(first.edges(D, 0).begin() + static_cast<std::ptrdiff_t>(before), first.edges(D, 0).end()) ==
          second.edges(D, 0));
    CHECK(second.edges(D, 0).size() > 20);
}
