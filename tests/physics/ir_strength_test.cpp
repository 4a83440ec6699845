// The default medium against the strengths that IRIDIA measured with real boards: median and spread of the
// range register at nine distances, both robots at random headings, through the board's own formula.

#include "protocols/infrared/rab_reading.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <numbers>
#include <optional>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

struct Measured {
    double surface, median, sigma;
};
constexpr Measured kMeasured[] = {{0.00, 2094, 0.357}, {0.02, 1991, 0.319}, {0.05, 1407, 0.193},
                                  {0.10, 1193, 0.153}, {0.15, 1080, 0.109}, {0.30, 1010, 0.122},
                                  {0.45, 919, 0.153},  {0.60, 924, 0.142},  {0.80, 924, 0.142}};
// 150 pairs of boards, 20 headings each: the median's own error is 1.5 % near, 0.5 % far.
constexpr int kPairs = 150, kHeadings = 20;

/// What board 1 reads of board 0, as its firmware computes it; nothing if no receiver hears.
std::optional<protocols::RabReading> read(IrMedium& medium) {
    const IrLight& light = shine(medium);
    std::array<int, kIrSensors> peaks{};
    bool heard = false;
    for (std::size_t k = 0; k < kIrSensors; ++k) {
        if (light.carrier[k] < medium.parameters(1).threshold) continue;
        heard = true;
        const auto dark = std::lround(medium.parameters(1).baseline[k]);
        peaks[k] = static_cast<int>(std::min(4095L, std::lround(light.level[k]) + dark) - dark);
    }
    return heard ? std::optional(protocols::rab_reading(peaks)) : std::nullopt;
}

struct Sample {
    std::vector<double> strength, bearing_error;  // logarithm; rad
    double sent = 0;
    double heard() const { return static_cast<double>(strength.size()); }
};

Sample sample(double surface) {
    Sample all;
    RandomStream random(11, "headings");
    for (int pair = 0; pair < kPairs; ++pair) {
        World world = rab_pair(surface);
        world.seed = 100 + static_cast<std::uint64_t>(pair);
        IrMedium medium(world);
        for (int i = 0; i < kHeadings; ++i) {
            const double heading = 2 * std::numbers::pi * random.uniform();
            medium.move(0, 0, 0, 2 * std::numbers::pi * random.uniform());
            medium.move(1, 2 * kBodyRadius + surface, 0, heading);
            ++all.sent;
            const auto reading = read(medium);
            if (!reading) continue;
            all.strength.push_back(std::log(reading->range));
            all.bearing_error.push_back(
                std::remainder(reading->bearing * 1e-4 - (std::numbers::pi - heading), 2 * std::numbers::pi));
        }
    }
    std::sort(all.strength.begin(), all.strength.end());
    return all;
}

double deviation(const std::vector<double>& values) {
    double mean = 0.0;
    double square = 0.0;
    for (const double v : values) {
        mean += v / static_cast<double>(values.size());
        square += v * v / static_cast<double>(values.size());
    }
    return std::sqrt(square - mean * mean);
}

}  // namespace

TEST_CASE("the range register has the measured medians and spreads") {
    for (const auto& measured : kMeasured) {
        const Sample s = sample(measured.surface);
        INFO("surface distance " << measured.surface);
        CHECK(s.heard() > 0.98 * s.sent);  // all nine were measured: the frames arrive
        const double median = std::exp(s.strength[s.strength.size() / 2]);
        CHECK(median == Approx(measured.median).epsilon(0.03));
        CHECK(deviation(s.strength) == Approx(measured.sigma).margin(0.055));
        CHECK(deviation(s.bearing_error) < 0.16);  // 9 deg
    }
}

TEST_CASE("the reach ends about a metre away") {
    CHECK(sample(1.0).heard() > 0.5 * kPairs * kHeadings);
    CHECK(sample(1.5).heard() < 0.05 * kPairs * kHeadings);
}
