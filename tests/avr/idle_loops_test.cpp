// Idle-loop elision: programs with and without it, everything compared.

#include "base/random.h"
#include "base/states/archive.h"
#include "tests/avr/random_loops.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <chrono>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;

namespace {

/// Timer interrupts that change a variable, a port and the stack; the main program waits in several ways.
const char* const kWaits = R"(
        jmp start
        .org 0x48           ; TIMER0_OVF
        push r24
        in   r24, SREG
        push r24
        lds  r24, 0x200
        inc  r24
        sts  0x200, r24
        sbi  PINB, 0
        pop  r24
        out  SREG, r24
        pop  r24
        reti
start:  ldi  r16, 0xFF
        out  DDRB, r16
        ldi  r16, 2
        out  TCCR0B, r16
        ldi  r16, 1
        sts  TIMSK0, r16
        ldi  r16, 0x08
        sts  UCSR0B, r16
        ldi  r16, 40
        sts  UBRR0L, r16
        sei
again:  lds  r20, 0x200
var:    lds  r21, 0x200     ; until the variable changes
        cp   r20, r21
        breq var
        sbi  PINB, 1
        sts  UDR0, r21
ready:  lds  r22, UCSR0A    ; until the buffer is free
        sbrs r22, 5
        rjmp ready
        sbi  PINB, 2
pin:    sbis PIND, 2        ; until a pin is high
        rjmp pin
        sbi  PINB, 3
        ldi  r25, 200       ; a delay
delay:  dec  r25
        brne delay
        ldi  r26, 0
        ldi  r27, 2
ptr:    ld   r24, X         ; through a pointer
        cp   r24, r21
        breq ptr
        sbi  PINB, 4
        cpi  r24, 60
        brlo again
end:    rjmp end
)";

struct Outcome {
    std::vector<std::tuple<int, int, int, Cycle>> edges;
    std::vector<cosim::Time> frames;
    Cycle cycles = 0;
    std::uint64_t instructions = 0;
    std::uint32_t pc = 0;
    double seconds = 0;

    bool same(const Outcome& other) const {
        return edges == other.edges && frames == other.frames && cycles == other.cycles &&
               instructions == other.instructions && pc == other.pc;
    }
};

Outcome run(bool skipping, std::uint64_t seed) {
    Rig rig(kWaits);
    rig.chip.set_skipping(skipping);
    RandomStream random(seed, "avr skip");
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < 400; ++i) {  // grants of any length, and a pin that changes in between
        rig.chip.run_until(rig.chip.now() + static_cast<cosim::Time>(random.below(300'000'000)));
        rig.set_pin({PortLetter::D, 2}, random.below(2));
    }
    Outcome outcome;
    outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    for (const Rig::Edge& e : rig.edges)
        outcome.edges.emplace_back(static_cast<int>(e.port), e.levels, e.driven, e.at);
    for (const auto& [unit, frame] : rig.frames)
        outcome.frames.push_back(frame.start);
    outcome.cycles = rig.chip.cycle();
    outcome.instructions = rig.chip.report().instructions;
    outcome.pc = rig.chip.pc();
    return outcome;
}

}  // namespace

TEST_CASE("skipping idle loops changes nothing that can be seen") {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Outcome with = run(true, seed), without = run(false, seed);
        REQUIRE(with.edges.size() > 100);
        REQUIRE(with.same(without));
    }
}

TEST_CASE("random waiting loops end in the same state with and without skipping") {
    std::uint64_t cycles = 0, skipped = 0;
    for (std::uint64_t seed = 1; seed <= 150; ++seed) {
        RandomStream random(seed, "avr loops");
        const std::string program = test::RandomLoops(random).program();
        INFO("seed " << seed << "\n" << program);
        Rig fast(program), slow(program);
        slow.chip.set_skipping(false);
        const auto saved = [](const Rig& rig) {
            std::vector<std::uint8_t> bytes;
            StateWriter writer(bytes);
            rig.chip.state(writer);
            return bytes;
        };
        for (int i = 0; i < 25; ++i) {
            const Pin pin{PortLetter::D, static_cast<std::uint8_t>(random.below(8))};
            const cosim::Time until = fast.chip.now() + static_cast<cosim::Time>(random.below(600'000'000));
            const bool level = random.below(2);
            for (Rig* rig : {&fast, &slow}) {
                rig->chip.run_until(until);
                rig->set_pin(pin, level);
            }
            const bool same = saved(fast) == saved(slow);
            REQUIRE(same);
        }
        REQUIRE(fast.edges.size() == slow.edges.size());
        CHECK(slow.chip.report().skipped == 0);
        cycles += fast.chip.report().cycles;
        skipped += fast.chip.report().skipped;
    }
    CHECK(skipped > cycles / 4);
}

TEST_CASE("an idle program runs a hundred times faster than it would") {
    const auto instructions_per_second = [](bool skipping, cosim::Time span) {
        Rig rig("loop: rjmp loop\n");
        rig.chip.set_skipping(skipping);
        const auto start = std::chrono::steady_clock::now();
        rig.chip.run_until(span);
        return static_cast<double>(rig.chip.report().instructions) /
               std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    CHECK(instructions_per_second(true, 100 * cosim::kSecond) >
          100 * instructions_per_second(false, cosim::kSecond / 4));
}
