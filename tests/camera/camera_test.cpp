// The camera as a chip: its I2C registers, reset, and what its registers make of a picture.

#include "emu/camera/camera.h"

#include "tests/camera/random_picture.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using camera::Camera;
using camera::Cycle;
using camera::Model;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;

namespace {

constexpr std::uint8_t kWriteAddress = 0xDC, kReadAddress = 0xDD;

I2cPhase phase(I2cPhaseKind kind, std::uint8_t byte = 0) {
    I2cPhase made;
    made.kind = kind;
    made.byte = byte;
    made.clock_period = 10 * cosim::kMicrosecond;
    return made;
}

void write(Camera& camera, std::uint8_t number, std::uint8_t value, Cycle now) {
    for (const std::uint8_t byte : {kWriteAddress, number, value}) {
        const bool address = byte == kWriteAddress && !camera.selected();
        const auto answer = camera.i2c(phase(address ? I2cPhaseKind::Start : I2cPhaseKind::Write, byte), now);
        REQUIRE(answer);
        CHECK(answer->kind == I2cPhaseKind::Acknowledge);
        CHECK(answer->ack == 1);
    }
    CHECK_FALSE(camera.i2c(phase(I2cPhaseKind::Stop), now));
}

std::uint8_t read(Camera& camera, std::uint8_t number) {
    camera.i2c(phase(I2cPhaseKind::Start, kWriteAddress), 0);
    camera.i2c(phase(I2cPhaseKind::Write, number), 0);
    camera.i2c(phase(I2cPhaseKind::Start, kReadAddress), 0);
    const auto answer = camera.i2c(phase(I2cPhaseKind::Read), 0);
    REQUIRE(answer);
    CHECK(answer->kind == I2cPhaseKind::Data);
    camera.i2c(phase(I2cPhaseKind::Stop), 0);
    return answer->byte;
}

/// All bytes of the row that begins at `rise`, in the middle of each.
std::vector<std::uint8_t> row_at(Camera& camera, Cycle rise, std::size_t bytes) {
    std::vector<std::uint8_t> row;
    for (std::size_t i = 0; i < bytes; ++i)
        row.push_back(camera.data(rise + 8 * i));
    return row;
}

}  // namespace

TEST_CASE("a camera says which one it is, keeps what is written, and forgets it in reset") {
    const auto pattern = camera::make_test_pattern();
    for (const Model model : {Model::Po3030k, Model::Po6030k}) {
        Camera camera({model}, *pattern);
        CHECK_FALSE(camera.i2c(phase(I2cPhaseKind::Start, kWriteAddress), 0));  // in reset
        camera.set_reset(true, 100);
        CHECK_FALSE(camera.i2c(phase(I2cPhaseKind::Start, 0xC0), 100));  // somebody else
        CHECK(read(camera, 0) == (model == Model::Po3030k ? 0x30 : 0x60));
        CHECK(read(camera, 1) == 0x30);
        RandomStream random(5, "registers");
        const auto value = static_cast<std::uint8_t>(1 + random.below(255));
        write(camera, 0x5C, value, 200);
        CHECK(read(camera, 0x5C) == value);
        write(camera, 0, 0x11, 200);
        CHECK(read(camera, 0) != 0x11);
        if (model == Model::Po6030k) {
            write(camera, 3, 1, 200);
            CHECK(read(camera, 0x5C) == 0);  // another bank
            write(camera, 3, 0, 200);
            CHECK(read(camera, 0x5C) == value);
        }
        camera.set_reset(false, 300);
        camera.set_reset(true, 400);
        CHECK(read(camera, 0x5C) == 0);
    }
}

TEST_CASE("what comes out of a PO3030K is the picture, pixel for pixel, in each format") {
    RandomStream random(6, "picture");
    const camera::Pixels pixels = tests::random_pixels(random, 160, 120);
    const auto scenery = camera::make_picture(pixels);
    Camera camera({Model::Po3030k}, *scenery);
    camera.set_reset(true, 0);
    for (const auto& [number, value] : {std::pair{0x1E, 0xCA}, {0x20, 0x33}, {0x1D, 0x20}})
        write(camera, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(value), 1000);
    const auto row = static_cast<std::uint32_t>(random.below(120));
    Cycle rise = 1000;
    for (std::uint32_t i = 0; i <= 2 * row; ++i)
        rise = camera.next_href(rise);
    const std::vector<std::uint8_t> colour = row_at(camera, rise, 320);
    for (std::uint32_t x = 0; x < 160; ++x) {
        const auto expected = tests::rgb565(pixels, x, row);
        CHECK((colour[2 * x] == expected[0] && colour[2 * x + 1] == expected[1]));
    }
    CHECK(camera.frames().size() == 1);
    CHECK(camera.data(rise - 50) == 0);  // HREF is low

    write(camera, 0x4E, 0x0C, rise + 5000);
    write(camera, 0x1D, 0x00, rise + 5000);
    rise += 5000;
    for (std::uint32_t i = 0; i <= 2 * row; ++i)
        rise = camera.next_href(rise);
    const std::vector<std::uint8_t> grey = row_at(camera, rise, 160);
    for (std::uint32_t x = 0; x < 160; ++x) {
        const std::uint8_t* p = &pixels.rgb[3 * (row * 160 + x)];
        CHECK(std::abs(0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2] - grey[x]) < 0.6);
    }

    // Turned over both ways, as the library leaves it after its own reset.
    write(camera, 0x1E, 0x0A, rise + 5000);
    rise += 5000;
    Cycle first = rise;
    for (std::uint32_t i = 0; i < 240 && camera.next_vsync(rise) > first; ++i)
        first = camera.next_href(first);
    CHECK(camera.mode().mirror);
    CHECK(camera.mode().flip);
}

TEST_CASE("exposure, gain and white balance show in the picture once they are manual") {
    const camera::Pixels grey{1, 1, {100, 100, 100}};
    const auto scenery = camera::make_picture(grey);
    Camera camera({Model::Po3030k}, *scenery);
    camera.set_reset(true, 0);
    const auto levels = [&](Cycle from) {
        const Cycle rise = camera.next_href(camera.next_vsync(from));
        const std::vector<std::uint8_t> bytes = row_at(camera, rise + 16, 2);
        const unsigned word = bytes[0] * 256u + bytes[1];
        return std::array{word >> 11, word >> 5 & 63, word & 31};
    };
    const Cycle frame = 852 * 489 * 16;
    write(camera, 0x1D, 0x40, 0);  // 8 cycles a byte in full size
    CHECK(levels(0) == std::array{12u, 25u, 12u});
    write(camera, 0xD4, 0x2C, 0);  // no automatic exposure
    write(camera, 0xB0, 0x0F, 0);
    write(camera, 0xB1, 0x98, 0);  // twice as long
    CHECK(levels(frame) == std::array{25u, 50u, 25u});
    write(camera, 0xD4, 0x1C, 0);  // no automatic white balance
    write(camera, 0x16, 0x80, 0);
    write(camera, 0x18, 0x20, 0);
    CHECK(levels(2 * frame) == std::array{25u, 25u, 6u});
}

TEST_CASE("a camera on its side shows the scene turned by a right angle") {
    RandomStream random(7, "turned");
    const camera::Pixels pixels = tests::random_pixels(random, 120, 160);
    const auto scenery = camera::make_picture(pixels);
    Camera camera({Model::Po3030k, true}, *scenery);
    camera.set_reset(true, 0);
    for (const auto& [number, value] : {std::pair{0x1E, 0xCA}, {0x20, 0x33}, {0x1D, 0x20}})
        write(camera, static_cast<std::uint8_t>(number), static_cast<std::uint8_t>(value), 1000);
    const auto column = static_cast<std::uint32_t>(random.below(120));  // of the scene: a row that comes out
    Cycle rise = 1000;
    for (std::uint32_t i = 0; i <= 2 * column; ++i)
        rise = camera.next_href(rise);
    const std::vector<std::uint8_t> bytes = row_at(camera, rise, 320);
    for (std::uint32_t i = 0; i < 160; ++i) {
        const auto expected = tests::rgb565(pixels, column, 159 - i);
        CHECK((bytes[2 * i] == expected[0] && bytes[2 * i + 1] == expected[1]));
    }
}
