// Chips that share program memory: what one writes or decodes no other sees, and nothing is left behind.

#include "base/random.h"
#include "emu/dspic/machine/program_pages.h"
#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

#include <map>
#include <memory>
#include <thread>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

struct Bare {
    SfrSpace sfr;
    EventQueue events;
    const DeviceInfo& device = dspic30f6014a();
    InterruptController interrupts{device, describe()};
    Core core{device, sfr, events, interrupts};

    SfrSpace& describe() {
        sfr.describe(device.registers);
        return sfr;
    }
    void start() {
        core.set_reset_hook([this](ResetCause) { sfr.reset_values(); });
        core.reset(ResetCause::PowerOn);
    }
};

/// Loop at 0x200 that adds `step` to W1, with `filler` behind it to the end of the memory used.
std::vector<ProgramWord> adder(std::uint32_t step, std::uint32_t filler) {
    const Program program = assemble("        goto 0x200\n        .org 0x200\nmore:   add #" +
                                     std::to_string(step) + ", w1\n        bra more\n");
    std::vector<ProgramWord> words;
    for (const auto& [address, word] : program.words)
        words.push_back({address, word});
    for (std::uint32_t address = 0x1000; address < 0x9000; address += 2)
        words.push_back({address, filler + address});
    return words;
}

}  // namespace

TEST_CASE("chips with one program share it until one of them writes") {
    const std::size_t before = ProgramPages::pieces_in_use();
    {
        const auto words = adder(3, 0x100000);
        std::vector<std::unique_ptr<Bare>> chips;
        std::size_t of_one = 0;
        for (int i = 0; i < 5; ++i) {
            chips.push_back(std::make_unique<Bare>());
            chips.back()->core.load(words);
            chips.back()->start();
            if (i == 0) of_one = ProgramPages::pieces_in_use();
        }
        CHECK(ProgramPages::pieces_in_use() == of_one);
        for (const auto& chip : chips)
            chip->core.run(1000);
        chips[2]->core.poke_program(0x200, 0xB00051);  // add #5, w1
        chips[2]->core.poke_program(0x8000, 0x123456);
        for (const auto& chip : chips) {
            chip->core.set_w(1, 0);
            chip->core.run(4000);
        }
        CHECK(chips[2]->core.w(1) / 5 == chips[1]->core.w(1) / 3);
        CHECK(chips[2]->core.program(0x8000) == 0x123456);
        CHECK(chips[3]->core.w(1) == chips[1]->core.w(1));
        CHECK(chips[3]->core.program(0x200) != 0xB00051);
        CHECK(chips[3]->core.program(0x8000) == 0x108000);

        // One that is loaded anew forgets what it decoded; another program is another piece.
        chips[4]->core.load(adder(7, 0x200000));
        chips[4]->core.set_pc(0x200);
        chips[4]->core.set_w(1, 0);
        chips[4]->core.run(chips[4]->core.cycle() + 300);
        CHECK(chips[4]->core.w(1) > 0);
        CHECK(chips[4]->core.w(1) % 7 == 0);
        CHECK(ProgramPages::pieces_in_use() > of_one);
        CHECK(chips[1]->core.program(0x8000) == 0x108000);
    }
    CHECK(ProgramPages::pieces_in_use() <= before + 1);  // the erased one may stay
}

TEST_CASE("stop addresses survive a load") {
    Bare chip;
    chip.core.load(adder(3, 0));
    const std::uint32_t stop[] = {0x202};
    chip.core.set_stops(stop);
    chip.start();
    CHECK(chip.core.run(1000) == Core::Outcome::Stopped);
    chip.core.load(adder(4, 0));
    chip.start();
    chip.core.set_w(1, 0);
    CHECK(chip.core.run(chip.core.cycle() + 1000) == Core::Outcome::Stopped);
    CHECK(chip.core.pc() == 0x202);
    CHECK(chip.core.w(1) == 4);
}

TEST_CASE("random words of many chips stay theirs, made and ended by several threads") {
    const auto life = [](std::uint64_t seed) {
        RandomStream random(seed, "words");
        std::vector<std::pair<std::unique_ptr<Bare>, std::map<std::uint32_t, std::uint32_t>>> chips;
        bool right = true;
        for (int i = 0; i < 40; ++i) {
            if (chips.size() > 4) chips.erase(chips.begin() + static_cast<std::ptrdiff_t>(random.below(4)));
            auto& [chip, expected] =
                chips.emplace_back(std::make_unique<Bare>(), std::map<std::uint32_t, std::uint32_t>());
            std::vector<ProgramWord> words;
            RandomStream shared(random.below(3), "image");  // chips of other threads have it, too
            for (int k = 0; k < 3000; ++k)
                words.push_back({2 * static_cast<std::uint32_t>(shared.below(49152)),
                                 static_cast<std::uint32_t>(shared.below(1u << 24))});
            chip->core.load(words);
            for (const ProgramWord& word : words)
                expected[word.address] = word.word;
            for (auto& [other, memory] : chips) {
                const auto address = 2 * static_cast<std::uint32_t>(random.below(49152));
                const auto word = static_cast<std::uint32_t>(random.below(1u << 24));
                other->core.poke_program(address, word);
                memory[address] = word;
                for (const auto& [at, value] : memory)
                    right = right && other->core.program(at) == value;
            }
        }
        return right;
    };
    bool first = false, second = false;
    std::thread other([&] { first = life(1); });
    second = life(2);
    other.join();
    CHECK(first);
    CHECK(second);
}
