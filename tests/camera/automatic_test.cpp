// Automatic exposure and white balance: a picture's mean comes back to the reference over some frames when
// the scene turns darker or brighter, as fast and as far as the registers say, and not at all when they say
// off.

#include "base/random.h"
#include "emu/camera/camera.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <numeric>

using namespace puckloop;
using camera::Camera;
using camera::Cycle;
using camera::Model;

namespace {

/// One colour everywhere, or with a spot of another in a quarter of the picture.
class Plain final : public camera::Scenery {
  public:
    std::array<std::uint8_t, 3> colour{100, 100, 100};
    std::optional<std::array<std::uint8_t, 3>> spot{};

    void render(std::uint32_t width, std::uint32_t height, std::uint64_t,
                std::span<std::uint8_t> rgb) override {
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x)
                std::ranges::copy(spot && 2 * x < width && 2 * y < height ? *spot : colour,
                                  rgb.begin() + 3 * (y * width + x));
    }
};

struct Bench {
    explicit Bench(Model model = Model::Po3030k) : camera({model}, scene) {
        camera.set_reset(true, 0);
        if (model == Model::Po3030k) write(0x20, 0x33);  // QQVGA
    }
    void write(std::uint8_t number, std::uint8_t value) {
        cosim::I2cPhase phase;
        phase.kind = cosim::I2cPhaseKind::Start;
        phase.byte = 0xDC;
        REQUIRE(camera.i2c(phase, now));
        phase.kind = cosim::I2cPhaseKind::Write;
        for (const std::uint8_t byte : {number, value}) {
            phase.byte = byte;
            REQUIRE(camera.i2c(phase, now));
        }
        phase.kind = cosim::I2cPhaseKind::Stop;
        camera.i2c(phase, now);
    }
    /// Means of red, green and blue in a picture of a frame to come, counts.
    std::array<double, 3> picture(int frame = 1) {
        for (; frame > 0; --frame)  // VSYNC rises and falls
            now = camera.next_vsync(camera.vsync(now) ? camera.next_vsync(now) : now);
        Cycle row = camera.next_href(now);
        if (!camera.href(row)) row = camera.next_href(row);
        camera.data(row);
        std::array<double, 3> sum{};
        const std::vector<std::uint8_t>& rgb = camera.last_picture().rgb;
        for (std::size_t i = 0; i < rgb.size(); ++i)
            sum[i % 3] += rgb[i];
        for (double& each : sum)
            each /= static_cast<double>(rgb.size() / 3);
        return sum;
    }
    double mean(int frame = 1) { return picture(frame)[1]; }

    Plain scene;
    Camera camera;
    Cycle now = 0;
};

constexpr double kReference = 0x70, kMargin = 2;

}  // namespace

TEST_CASE("the picture's mean returns to the reference when the scene turns darker and brighter") {
    for (const Model model : {Model::Po3030k, Model::Po6030k, Model::Po8030d}) {
        Bench bench(model);
        for (int i = 0; i < 10; ++i)
            bench.mean();
        CHECK(std::abs(bench.mean() - kReference) <= kMargin + 0.5);
        bench.scene.colour = {40, 40, 40};
        // The exposure is still that of the bright scene; half of what is missing comes back each frame.
        CHECK(bench.mean() == Approx(kReference * 40 / 100).margin(2));
        double missing = kReference - kReference * 40 / 100;
        for (int i = 0; i < 4; ++i) {
            missing /= 2;
            CHECK(kReference - bench.mean() == Approx(missing).margin(2));
        }
        for (int i = 0; i < 4; ++i)
            bench.mean();
        CHECK(std::abs(bench.mean() - kReference) <= kMargin + 0.5);
        bench.scene.colour = {80, 80, 80};
        CHECK(bench.mean() == Approx(2 * kReference).margin(6));
        CHECK(bench.mean() == Approx(kReference * 1.25).margin(4));  // three quarters go at once
        for (int i = 0; i < 4; ++i)
            bench.mean();
        CHECK(std::abs(bench.mean() - kReference) <= kMargin + 0.5);
    }
}

TEST_CASE("exposure that the registers fix stays, and reference, speeds and bounds are theirs") {
    Bench fixed;
    fixed.write(0xD4, 0x2C);
    for (const std::uint8_t level : std::array<std::uint8_t, 3>{100, 30, 200}) {
        fixed.scene.colour = {level, level, level};
        for (int i = 0; i < 5; ++i)
            CHECK(fixed.mean() == level);
    }

    RandomStream random(12, "automatic exposure");
    for (int round = 0; round < 20; ++round) {
        Bench bench;
        const auto reference = static_cast<std::uint8_t>(60 + random.below(100));
        const unsigned rise = 1 + static_cast<unsigned>(random.below(15));
        const unsigned fall = 1 + static_cast<unsigned>(random.below(15));
        const auto level = static_cast<std::uint8_t>(40 + random.below(160));
        CAPTURE(+reference, rise, fall, +level);
        bench.write(0xB3, reference);
        bench.write(0xAF, static_cast<std::uint8_t>(rise << 4 | fall));
        bench.write(0xAE, 0x20);  // no margin
        bench.scene.colour = {level, level, level};
        double mean = bench.mean(2);  // the frame before saw the scene, too
        for (int i = 0; i < 6 && mean < 250; ++i) {
            const double share = (mean < reference ? rise : fall) / 16.0;
            const double expected = mean + share * (reference - mean);
            mean = bench.mean();
            CHECK(mean == Approx(std::min(expected, 255.0)).margin(1.5));
        }
    }

    Bench dark;
    dark.scene.colour = {5, 5, 5};
    dark.mean(80);
    CHECK(dark.mean() == 20);  // longest exposure and an analogue gain of 4
    dark.write(0xBB, 0x03);    // half of the longest exposure
    dark.write(0xBC, 0xE6);
    CHECK(dark.mean(3) == 10);
    Bench bright;
    bright.write(0xBD, 0x07);  // the shortest is the longest
    bright.write(0xBE, 0xCC);
    bright.scene.colour = {200, 200, 200};
    CHECK(bright.mean(20) == 200);
}

TEST_CASE("frames that nobody reads let exposure come to rest all the same") {
    Bench read, unread;
    for (Bench* bench : {&read, &unread}) {
        bench->mean();
        bench->scene.colour = {50, 50, 50};
    }
    for (int i = 0; i < 29; ++i)
        read.mean();
    CHECK(read.mean() == unread.mean(30));
    CHECK(read.camera.frames().size() == 31);
    CHECK(unread.camera.frames().size() == 2);
    CHECK(read.camera.frames().back().gain == Approx(unread.camera.frames().back().gain).epsilon(1e-9));
}

TEST_CASE("white balance makes nearly grey grey, and leaves colours and what is fixed alone") {
    Bench bench;
    bench.scene.colour = {120, 90, 70};
    const std::array<double, 3> first = bench.picture();
    CHECK(first[0] > 1.2 * first[1]);
    const std::array<double, 3> then = bench.picture(40);
    CHECK(then[0] == Approx(then[1]).margin(1.5));
    CHECK(then[2] == Approx(then[1]).margin(1.5));

    Bench fixed;
    fixed.write(0xD4, 0x1C);
    fixed.scene.colour = {120, 90, 70};
    const std::array<double, 3> kept = fixed.picture(40);
    CHECK(kept[0] / kept[1] == Approx(120.0 / 90).epsilon(0.02));

    // A red spot on grey does not turn the grey green, and red alone stays red.
    Bench spot;
    spot.scene.spot = {200, 20, 20};
    spot.picture(40);
    const std::vector<std::uint8_t>& rgb = spot.camera.last_picture().rgb;
    CHECK(rgb[rgb.size() - 3] == rgb[rgb.size() - 2]);
    Bench red;
    red.scene.colour = {150, 30, 30};
    const std::array<double, 3> stays = red.picture(40);
    CHECK(stays[0] / stays[1] == Approx(5.0).epsilon(0.05));
}

TEST_CASE("a reset begins with the default exposure") {
    Bench bench;
    bench.scene.colour = {50, 50, 50};
    bench.mean(30);
    bench.camera.set_reset(false, bench.now + 1);
    bench.camera.set_reset(true, bench.now + 2);
    bench.now += 2;
    bench.scene.colour = {100, 100, 100};
    // VGA now: the first VSYNC is that of frame 0, which nobody saw yet.
    CHECK(bench.mean() == 100);
}
