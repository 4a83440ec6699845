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

TEST_CASE("a camera has its identification, keeps what is written, and forgets it in reset") {
    const auto pattern = camera::make_test_pattern();
    for (const Model model : {Model::Po3030k, Model::Po6030k, Model::Po8030d}) {
        Camera camera({model}, *pattern);
        CHECK_FALSE(camera.i2c(phase(I2cPhaseKind::Start, kWriteAddress), 0));  // in reset
        camera.set_reset(true, 100);
        CHECK_FALSE(camera.i2c(phase(I2cPhaseKind::Start, 0xC0), 100));  // somebody else
        CHECK(read(camera, 0) == std::array{0x30, 0x60, 0x80}[static_cast<std::size_t>(model)]);
        CHECK(read(camera, 1) == 0x30);
        RandomStream random(5, "registers");
        const auto value = static_cast<std::uint8_t>(1 + random.below(255));
        write(camera, 0x5C, value, 200);
        CHECK(read(camera, 0x5C) == value);
        write(camera, 0, 0x11, 200);
        CHECK(read(camera, 0) != 0x11);
        if (model != Model::Po3030k) {
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
    for (const auto& [number, value] : {std::pair{0x1E, 0xCA}, {0x20, 0x33}, {0x1D, 0x20}, {0xD4, 0x0C}})
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

TEST_CASE("a PO8030D set up as the e-puck library does gives what its routine reads") {
    RandomStream random(8, "po8030d");
    const camera::Pixels pixels = tests::random_pixels(random, 160, 120);
    const auto scenery = camera::make_picture(pixels);
    Camera camera({Model::Po8030d}, *scenery);
    camera.set_reset(true, 0);
    // 40 x 40 of the middle 320 x 320: each write chooses its bank first. The driver gives rows no window.
    struct Setting {
        int bank, number, value;
    };
    const auto set = [&](std::initializer_list<Setting> settings, Cycle now) {
        for (const Setting& one : settings) {
            write(camera, 3, static_cast<std::uint8_t>(one.bank), now);
            write(camera, static_cast<std::uint8_t>(one.number), static_cast<std::uint8_t>(one.value), now);
        }
    };
    constexpr int kFirst = 39, kLast = 235;
    set({{0, 0x5B, 0}, {0, 0x6C, 0}, {0, 0x09, kFirst}, {0, 0x08, 0}, {0, 0x0C, 0}, {0, 0x0D, kLast}}, 1000);
    set({{0, 0x11, 0x0A}, {0, 0x6A, 0x05}, {1, 0x4E, 0x30}, {1, 0xB7, 0}, {1, 0x93, 0x80}, {1, 0x94, 0x80}},
        1000);
    set({{2, 0x04, 0x9D}}, 1000);   // the picture as it is
    constexpr Cycle kRoutine = 15;  // cycles from HREF to the first byte, then one in 8
    const Cycle frame = camera.next_vsync(1000);
    const auto row = static_cast<std::uint32_t>(random.below(120));
    Cycle rise = camera.next_href(frame);
    for (std::uint32_t i = 0; i < 2 * row; ++i)
        rise = camera.next_href(rise);
    REQUIRE(camera.href(rise));
    const std::vector<std::uint8_t> colour = row_at(camera, rise + kRoutine, 160);
    for (std::uint32_t x = 0; x < 80; ++x) {
        const auto expected = tests::rgb565(pixels, kFirst + x, row);
        CHECK((colour[2 * x] == expected[0] && colour[2 * x + 1] == expected[1]));
    }
    // 18.4 frames a second at full speed, an eighth of it here.
    const Cycle falls = camera.next_vsync(frame);
    CHECK(camera.next_vsync(falls) - frame == Cycle{776} * 516 * 16);

    // Grey: half the clock's divider, one byte a pixel, so twice the rate.
    set({{0, 0x11, 0x03}, {0, 0x6A, 0x04}, {1, 0x4E, 0x43}, {1, 0xB7, 1}}, falls);
    const Cycle grey_frame = camera.next_vsync(falls);
    rise = camera.next_href(grey_frame);
    for (std::uint32_t i = 0; i < 2 * row; ++i)
        rise = camera.next_href(rise);
    const std::vector<std::uint8_t> grey = row_at(camera, rise + kRoutine, 80);
    for (std::uint32_t x = 0; x < 80; ++x) {
        const std::uint8_t* p = &pixels.rgb[3 * (row * 160 + kFirst + 1 + x)];
        CHECK(std::abs(0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2] - grey[x]) < 0.6);
    }
    CHECK(camera.next_vsync(camera.next_vsync(grey_frame)) - grey_frame == Cycle{776} * 516 * 8);
}

TEST_CASE("luma comes first in YUV") {
    const camera::Pixels green{1, 1, {0, 200, 0}};
    const auto scenery = camera::make_picture(green);
    struct Setting {
        std::uint8_t bank, number, value;
    };
    const auto check = [&](Model model, std::initializer_list<Setting> settings) {
        Camera camera({model}, *scenery);
        camera.set_reset(true, 0);
        for (const Setting& one : settings) {
            if (model != Model::Po3030k) write(camera, 3, one.bank, 0);
            write(camera, one.number, one.value, 0);
        }
        Cycle rise = camera.next_href(camera.next_vsync(0));
        if (!camera.href(rise)) rise = camera.next_href(rise);
        constexpr int kLuma = 117, kU = 62, kV = 44;  // ITU-R BT.601
        const std::vector<std::uint8_t> row = row_at(camera, rise, 4);
        CHECK(row == std::vector<std::uint8_t>{kLuma, kU, kLuma, kV});
    };
    check(Model::Po3030k, {{0, 0xD4, 0x0C}, {0, 0x4E, 0x02}, {0, 0x1D, 0x40}});
    check(Model::Po6030k, {{2, 0x04, 0x9D}, {1, 0x38, 0x02}, {0, 0x91, 0xD0}});
    check(Model::Po8030d, {{2, 0x04, 0x9D}, {1, 0x4E, 0x02}, {0, 0x6A, 0x05}});
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
    write(camera, 0xD4, 0x0C, 0);  // no automatic white balance
    write(camera, 0xB0, 0x07, 0);
    write(camera, 0xB1, 0xCC, 0);
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
