// Random C programs by Debian's avr-gcc, at several levels of optimisation: the same output and clocks as on
// simavr, translated and interpreted. (Levels may differ: C leaves the order of evaluation open.)

#include "base/random.h"
#include "emu/avr/chip/chip.h"
#include "emu/image/avr_image.h"
#include "tests/avr/random_c.h"
#include "tests/avr/simavr.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <string>

using namespace puckloop;
using namespace puckloop::avr;

namespace {

constexpr Cycle kMostCycles = 40'000'000;

struct Result {
    std::string output;
    Cycle cycles = 0;
    bool finished = false;
};

template <class ByteAt>
std::string output_of(const image::AvrImage& image, ByteAt byte_at) {
    const auto length_at = static_cast<std::uint16_t>(image.symbols.at("output_length").address);
    const auto text_at = static_cast<std::uint16_t>(image.symbols.at("output").address);
    const int length = byte_at(length_at) | byte_at(static_cast<std::uint16_t>(length_at + 1)) << 8;
    std::string text;
    for (int i = 0; i < length; ++i)
        text += static_cast<char>(byte_at(static_cast<std::uint16_t>(text_at + i)));
    return text;
}

Result on_chip(const image::AvrImage& image, bool plain) {
    Pins pins;
    Chip chip(atmega1284p(), pins);
    chip.set_translating(!plain);
    chip.set_skipping(!plain);
    chip.load(image);
    chip.power_on();
    chip.stop_at(*image.find_code("finished"));
    chip.run_until(chip.clock().time_of(kMostCycles));
    CHECK(chip.report().warnings.empty());
    return {output_of(image, [&](std::uint16_t at) { return chip.peek_data(at); }), chip.cycle(),
            chip.stopped_at().has_value()};
}

Result on_simavr(const image::AvrImage& image) {
    test::Simavr simavr;
    for (const image::ByteSegment& segment : image.flash)
        for (std::size_t i = 0; i + 1 < segment.bytes.size(); i += 2)
            simavr.set_program(static_cast<std::uint32_t>(segment.address + i) / 2,
                               static_cast<std::uint16_t>(segment.bytes[i] | segment.bytes[i + 1] << 8));
    simavr.run_to(*image.find_code("finished"));
    return {output_of(image, [&](std::uint16_t at) { return simavr.data(at); }), simavr.state().cycle, true};
}

}  // namespace

TEST_CASE("random C programs do the same as on simavr, at every level of optimisation") {
    const char* const given = std::getenv("PUCKLOOP_AVR_SEEDS");
    const int seeds = given ? std::atoi(given) : 6;
    const char* const from = std::getenv("PUCKLOOP_AVR_FIRST_SEED");
    const int first = from ? std::atoi(from) : 1;
    int compared = 0;
    for (int seed = first; seed < first + seeds; ++seed) {
        RandomStream random(static_cast<std::uint64_t>(seed), "avr C");
        const std::string source = tests::scratch_path("program").string();
        std::ofstream(source) << test::RandomC(random).program();
        for (const char* level : {"-O0", "-O2", "-Os", "-O3"}) {
            INFO("seed " << seed << " " << level);
            const std::string elf = source + ".elf";
            const std::string command = std::string(AVR_GCC) + " -mmcu=atmega1284p -std=gnu99 -w " + level +
                                        " -o " + elf + " -x c " + source + " -lm";
            REQUIRE(std::system(command.c_str()) == 0);
            const image::AvrImage image = image::load_avr_image(elf, atmega1284p().image_part());
            const Result ours = on_chip(image, false);
            if (!ours.finished) break;  // a long one
            const Result plain = on_chip(image, true), theirs = on_simavr(image);
            REQUIRE(ours.output == theirs.output);
            REQUIRE(ours.cycles == theirs.cycles);
            REQUIRE(plain.output == ours.output);
            REQUIRE(plain.cycles == ours.cycles);
            REQUIRE(ours.output.size() == 81);
            ++compared;
        }
    }
    CHECK(compared >= seeds);
}
