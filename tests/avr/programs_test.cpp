// Programs made by avr-gcc and avr-libc: the same output and the same number of cycles as on simavr.

#include "emu/avr/chip/chip.h"
#include "emu/image/avr_image.h"
#include "tests/avr/simavr.h"

#include <catch2/catch.hpp>

#include <chrono>
#include <string>

using namespace puckloop;
using namespace puckloop::avr;

namespace {

constexpr cosim::Time kLongest = 20 * cosim::kSecond;

struct Result {
    std::string output;
    Cycle cycles = 0;
    double seconds = 0;  ///< on the wall
};

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

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

Result on_chip(const image::AvrImage& image) {
    Pins pins;
    Chip chip(atmega1284p(), pins);
    chip.load(image);
    chip.power_on();
    chip.stop_at(*image.find_code("finished"));
    const double start = now();
    chip.run_until(kLongest);
    REQUIRE(chip.stopped_at());
    CHECK(chip.report().warnings.empty());
    CHECK(chip.report().unmodelled.empty());
    return {output_of(image, [&](std::uint16_t at) { return chip.peek_data(at); }), chip.cycle(),
            now() - start};
}

Result on_simavr(const image::AvrImage& image) {
    test::Simavr simavr;
    for (const image::ByteSegment& segment : image.flash)
        for (std::size_t i = 0; i + 1 < segment.bytes.size(); i += 2)
            simavr.set_program(static_cast<std::uint32_t>(segment.address + i) / 2,
                               static_cast<std::uint16_t>(segment.bytes[i] | segment.bytes[i + 1] << 8));
    const double start = now();
    simavr.run_to(*image.find_code("finished"));
    return {output_of(image, [&](std::uint16_t at) { return simavr.data(at); }), simavr.state().cycle,
            now() - start};
}

void check_program(const std::string& file) {
    const image::AvrImage image = image::load_avr_image(file, atmega1284p().image_part());
    const Result ours = on_chip(image), theirs = on_simavr(image);
    CHECK(ours.output == theirs.output);
    CHECK(ours.output.size() > 1000);
    CHECK(ours.output.starts_with("176366841446208112\n"));  // 1234567890123456789 / 7
    CHECK(ours.cycles == theirs.cycles);
    WARN(file.substr(file.rfind('/') + 1)
         << ": " << ours.cycles << " cycles, " << static_cast<double>(ours.cycles) / ours.seconds / 1e6
         << " MHz here, " << static_cast<double>(theirs.cycles) / theirs.seconds / 1e6 << " MHz simavr");
}

}  // namespace

TEST_CASE("avr-gcc's programs give the output and take the cycles of simavr: -O0") {
    check_program(AVR_PROGRAMS "/compute-O0.elf");
}
TEST_CASE("avr-gcc's programs give the output and take the cycles of simavr: -O2") {
    check_program(AVR_PROGRAMS "/compute-O2.elf");
}
TEST_CASE("avr-gcc's programs give the output and take the cycles of simavr: -Os") {
    check_program(AVR_PROGRAMS "/compute-Os.elf");
}
