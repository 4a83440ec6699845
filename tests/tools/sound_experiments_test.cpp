// The experiments with sound: their arithmetic on drawn values, and short runs of the project's own firmware.
// All draws follow Catch's seed (--rng-seed): a case that fails does so again.

#include "reproductions/ellipse.h"
#include "reproductions/experiments.h"

#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

using namespace puckloop::tools;

namespace {

SoundOptions options(const std::string& folder) {
    SoundOptions options;
    options.firmware = options.walker = std::string(PUCKLOOP_SOURCE) + "/firmware/sound/sound.hex";
    options.folder = puckloop::tests::scratch_path(folder);
    options.trials = 1;
    options.seed = Catch::rngSeed();
    return options;
}

}  // namespace

TEST_CASE("an ellipse's points give the ellipse back") {
    std::mt19937 random(Catch::rngSeed());
    const auto draw = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (int round = 0; round < 200; ++round) {
        const double minor = draw(0.05, 1.0), major = minor * draw(1.05, 5.0);
        const double x = draw(-3, 3), y = draw(-3, 3), angle = draw(-1.5, 1.5);
        std::vector<std::pair<double, double>> points;
        for (int i = 0; i < 24; ++i) {
            const double turn = 2 * std::numbers::pi * i / 24 + draw(-0.1, 0.1);
            const double a = major * std::cos(turn), b = minor * std::sin(turn);
            points.emplace_back(x + a * std::cos(angle) - b * std::sin(angle),
                                y + a * std::sin(angle) + b * std::cos(angle));
        }
        const auto fit = fit_ellipse(points);
        REQUIRE(fit);
        CHECK(fit->x == Approx(x).margin(1e-6));
        CHECK(fit->y == Approx(y).margin(1e-6));
        CHECK(fit->major == Approx(major).epsilon(1e-6));
        CHECK(fit->minor == Approx(minor).epsilon(1e-6));
        CHECK(std::abs(std::sin(fit->angle - angle)) < 1e-5);
        CHECK(fit->area() == Approx(std::numbers::pi * major * minor));
    }
    CHECK_FALSE(fit_ellipse({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}, {5, 5}}));
    CHECK_FALSE(fit_ellipse({{0, 0}, {1, 0}, {0, 1}, {1, 1}}));
    CHECK_FALSE(fit_ellipse({{2, 2}, {2, 2}, {2, 2}, {2, 2}, {2, 2}}));
}

TEST_CASE("volumes are read from BTcom's answer and from nothing else") {
    Volumes volumes;
    REQUIRE(parse_volumes("u,12,345,6", volumes));
    CHECK(volumes.counts == std::array<double, 3>{12, 345, 6});
    CHECK(volumes.mean() == Approx(121));
    for (const char* line : {"", "u", "u,1,2", "u,1,2,3,4", "u,1,2,3x", "t", "d,1,2,3"})
        CHECK_FALSE(parse_volumes(line, volumes));
}

TEST_CASE("five calls are heard, as long and in the order that they were played", "[sound]") {
    const Readings readings = five_sounds(options("calls"));
    REQUIRE(readings.size() == 1);
    for (int call = 0; call < kCalls; ++call) {
        const double from = kFirstCall + call * kCallSpacing;
        const double length = kCallWords[static_cast<std::size_t>(call)] / kCallRate;
        int loud = 0, asked = 0;
        for (const Volumes& one : readings.front()) {
            // A volume is of the last whole window of 14.2 ms, of which two must fit.
            const double into = one.at - from;
            if (into > 0.035 && into < length - 0.005) {
                ++asked;
                if (one.mean() > 25) ++loud;
            }
            if (into > length + 0.035 && into < kCallSpacing - 0.01) CHECK(one.mean() < 20);
        }
        CAPTURE(call, loud, asked);
        CHECK(asked > 5);
        CHECK(loud == asked);
    }
}

TEST_CASE("what is farther is quieter, and a walker hears its caller", "[sound]") {
    const Readings readings = sound_against_distance(options("distance"));
    const auto bins = binned(readings, 0.05);
    REQUIRE(bins.size() >= 5);
    for (std::size_t i = 1; i < bins.size(); ++i)
        CHECK(bins[i].median < bins[i - 1].median);
    CHECK(bins.front().at == Approx(0.1).margin(0.051));
    CHECK(bins.back().at == Approx(0.3).margin(0.026));

    SoundOptions walk = options("ears");
    walk.walk_s = 20;
    const Ears ears = ears_and_radio(walk);
    CHECK(ears.calls == 4);
    CHECK(ears.heard.size() >= 2);
    CHECK(ears.heard.size() <= 4);
    for (const Heard& one : ears.heard) {
        CHECK(std::max(std::abs(one.x), std::abs(one.y)) < 0.27);
        const double since = std::fmod(one.seconds - 0.5, 5.0);
        CHECK(since < kCallWords[4] / kCallRate + 0.05);
    }
    // It leaves its corner; where its walk has taken it by the end is chance, and that may be back.
    double farthest = 0.0;
    for (const auto& point : ears.path)
        farthest = std::max(farthest, std::hypot(point.x + 0.2, point.y + 0.2));
    CHECK(farthest > 0.05);
}
