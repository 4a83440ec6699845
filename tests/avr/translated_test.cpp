// Translated code against the interpreter in lockstep: random words, random waiting loops, every fast path on
// and off, cut at random instants, with interrupts and writes to the program meanwhile: the same saved state.

#include "base/random.h"
#include "base/states/archive.h"
#include "emu/avr/isa/isa.h"
#include "emu/chip/translate/translation_switch.h"
#include "tests/avr/random_loops.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

#include <memory>

using namespace puckloop;
using namespace puckloop::avr;
using test::Rig;

namespace {

std::vector<std::uint8_t> saved(const Chip& chip) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    chip.state(writer);
    return bytes;
}

/// A chip that translates at the first arrival.
template <class... Arguments>
std::unique_ptr<Rig> translating(const Arguments&... arguments) {
    chip::set_translation(true, 1);
    auto rig = std::make_unique<Rig>(arguments...);
    chip::set_translation(true);
    return rig;
}

constexpr std::uint32_t kWords = 1024;

/// A word of a form that a program may consist of, its fields random.
std::uint16_t random_word(RandomStream& random) {
    while (true) {
        const auto word = static_cast<std::uint16_t>(random.below(0x10000));
        switch (find_form_id(word)) {
        case FormId::SPM:
        case FormId::SLEEP:
        case FormId::Undefined:
            continue;
        case FormId::IJMP:
        case FormId::ICALL:
        case FormId::RET:
        case FormId::RETI:
            if (random.below(4)) continue;
            return word;
        case FormId::SBI:
        case FormId::CBI:
            return static_cast<std::uint16_t>((word & 0xFF07) | (random.below(2) ? 0x03 : 0x1E) << 3);
        case FormId::OUT: {  // PINB, GPIOR1, SPH, SREG, TCNT0
            constexpr std::uint16_t kPlaces[] = {0x03, 0x2A, 0x3F, 0x26, 0x2A, 0x05};
            const std::uint16_t place = kPlaces[random.below(6)];
            return static_cast<std::uint16_t>((word & 0xF9F0) | (place & 0x30) << 5 | (place & 0x0F));
        }
        case FormId::RJMP:
        case FormId::RCALL: {  // near
            const auto offset = static_cast<std::uint16_t>(random.below(40)) - 24;
            return static_cast<std::uint16_t>((word & 0xF000) | (offset & 0x0FFF));
        }
        default:
            return word;
        }
    }
}

image::AvrImage random_image(RandomStream& random) {
    std::vector<std::uint16_t> words;
    const auto emit = [&](std::uint16_t word) { words.push_back(word); };
    while (words.size() < kWords) {
        const std::uint16_t word = random_word(random);
        switch (find_form_id(word)) {
        case FormId::JMP:
        case FormId::CALL:
            emit(word & 0xFE0E);
            emit(static_cast<std::uint16_t>(random.below(kWords)));
            break;
        case FormId::LDS:
        case FormId::STS:  // in RAM, mostly
            emit(word);
            emit(static_cast<std::uint16_t>(random.below(8) ? 0x100 + random.below(0x4000)
                                                            : random.below(0x32)));
            break;
        default:
            emit(word);
        }
        if (random.below(12) == 0) {  // a pointer into RAM
            const auto high = static_cast<std::uint16_t>(27 + 2 * random.below(3));
            emit(static_cast<std::uint16_t>(0xE000 | (high - 16) << 4 | (1 + random.below(15))));
        }
    }
    image::AvrImage image;
    for (std::uint32_t i = 0; i < kWords; ++i)
        image.flash.push_back(
            {2 * i, {static_cast<std::uint8_t>(words[i]), static_cast<std::uint8_t>(words[i] >> 8)}});
    return image;
}

}  // namespace

TEST_CASE("random words do the same translated, with loops skipped, and neither") {
    std::uint64_t instructions = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        RandomStream random(seed, "avr words");
        const image::AvrImage image = random_image(random);
        Pins pins;
        chip::set_translation(true, 1);
        Chip fast(atmega1284p(), pins), plain(atmega1284p(), pins), skipping(atmega1284p(), pins);
        chip::set_translation(true);
        plain.set_translating(false);
        plain.set_skipping(false);
        skipping.set_translating(false);
        for (Chip* chip : {&fast, &plain, &skipping}) {
            chip->load(image);
            chip->power_on();
        }
        for (int i = 0; i < 60; ++i) {
            const cosim::Time until =
                fast.now() + 1 +
                static_cast<cosim::Time>(random.below(random.below(2) ? 3'000'000 : 60'000'000));
            for (Chip* chip : {&fast, &plain, &skipping})
                chip->run_until(until);
            INFO("seed " << seed << ", run " << i << ", pc " << fast.pc() << " and " << plain.pc());
            REQUIRE(fast.cycle() == plain.cycle());
            const auto expected = saved(plain);
            const bool same = saved(fast) == expected, same_skipping = saved(skipping) == expected;
            REQUIRE(same);
            REQUIRE(same_skipping);
        }
        instructions += plain.report().instructions;
    }
    CHECK(instructions > 300'000);
}

TEST_CASE("random waiting loops do the same translated") {
    for (std::uint64_t seed = 1; seed <= 80; ++seed) {
        RandomStream random(seed, "avr translated loops");
        const std::string program = test::RandomLoops(random).program();
        INFO("seed " << seed << "\n" << program);
        const auto fast = translating(program), slow = translating(program);
        slow->chip.set_skipping(false);
        slow->chip.set_translating(false);
        for (int i = 0; i < 20; ++i) {
            const Pin pin{PortLetter::D, static_cast<std::uint8_t>(random.below(8))};
            const cosim::Time until = fast->chip.now() + static_cast<cosim::Time>(random.below(600'000'000));
            const bool level = random.below(2);
            for (Rig* rig : {fast.get(), slow.get()}) {
                rig->chip.run_until(until);
                rig->set_pin(pin, level);
            }
            const bool same = saved(fast->chip) == saved(slow->chip);
            REQUIRE(same);
        }
    }
}

TEST_CASE("stop addresses and a program that is replaced hold in translated code") {
    const std::string source =
        "start: ldi r24, 0\nloop: inc r24\n adiw r26, 1\n eor r20, r24\n brne loop\n rjmp start\n";
    const auto rig = translating(source);
    rig->run(5000);
    const std::uint32_t loop = static_cast<std::uint32_t>(rig->program.symbol("loop"));
    rig->chip.stop_at(loop + 2);
    rig->run(6000);
    REQUIRE(rig->chip.stopped_at());
    CHECK(*rig->chip.stopped_at() == loop + 2);
    const std::uint8_t before = static_cast<std::uint8_t>(rig->chip.report().instructions);
    rig->run(6000);
    REQUIRE(rig->chip.stopped_at());  // again, a turn later
    CHECK(static_cast<std::uint8_t>(rig->chip.report().instructions - before) <= 6);
    // Another program in the same place.
    const auto other = translating(source);
    other->run(5000);
    image::AvrImage image;
    image.flash.push_back({loop, {0x8F, 0xEF}});  // ldi r24, 0xFF
    other->chip.load(image);
    const auto never = translating(source);
    never->chip.set_translating(false);
    never->run(5000);
    never->chip.load(image);
    for (Rig* r : {other.get(), never.get()})
        r->run(9000);
    const bool same = saved(other->chip) == saved(never->chip);
    CHECK(same);
}
