// Peaks to registers: the vectors measured at the real board's firmware (range-and-bearing facts, 4.4).

#include "protocols/infrared/rab_reading.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <initializer_list>
#include <utility>

using namespace puckloop::protocols;

namespace {

std::array<int, kRabSensors> peaks(std::initializer_list<std::pair<int, int>> values) {
    std::array<int, kRabSensors> all{};
    for (const auto& [sensor, value] : values)
        all[static_cast<std::size_t>(sensor)] = value;
    return all;
}

struct Vector {
    std::initializer_list<std::pair<int, int>> peaks;
    int bearing, range, peak, sensor;
};

}  // namespace

TEST_CASE("bearing, range, peak and sensor are the board's") {
    const Vector vectors[] = {
        {{{0, 1000}, {1, 550}, {11, 600}}, 2696, 1041, 1000, 0},
        {{{0, 1500}, {1, 800}, {11, 900}}, 2648, 1561, 1500, 0},
        {{{0, 1000}, {11, 1000}}, 0, 1210, 1000, 0},
        {{{0, 1000}, {1, 500}}, 4625, 1027, 1000, 0},
        {{{0, 500}, {1, 1000}}, 6719, 1027, 1000, 1},
        {{{5, 900}, {6, 900}}, 30892, 1097, 900, 5},
        {{{5, 1000}, {6, 400}}, 29508, 1015, 1000, 5},
        {{{5, 300}, {6, 2000}, {7, 1500}}, -27192, 2170, 2000, 6},
        {{{2, 1200}, {3, 1200}}, 0, 2805, 1200, 2},  // the firmware's special case
        {{{2, 1000}, {8, 1000}}, 0, 2337, 1000, 2},
        {{{7, 2000}, {8, 4095}, {9, 4095}}, -17352, 4975, 4095, 8},
        {{{9, 700}, {10, 650}}, -11171, 815, 700, 9},
        {{{0, 2400}, {1, 500}, {10, 600}, {11, 2500}}, -188, 2966, 2500, 11},
        {{{0, 4095}, {6, 4095}}, 0, 4954, 4095, 0},
        {{{4, 1991}, {5, 1117}, {6, 858}}, 26730, 2098, 1991, 4},
        {{{7, 242}, {8, 1997}, {9, 1243}}, -16935, 2085, 1997, 8},
        {{{0, 542}, {1, 871}, {2, 1178}}, 9509, 1290, 1178, 2},
        {{}, 0, 0, 0, 0},
    };
    for (const auto& v : vectors) {
        const auto reading = rab_reading(peaks(v.peaks));
        INFO("range " << v.range << ", bearing " << v.bearing);
        CHECK(reading.bearing == v.bearing);
        CHECK(reading.range == v.range);
        CHECK(reading.peak == v.peak);
        CHECK(reading.sensor == v.sensor);
    }
}

TEST_CASE("a single sensor points along its own angle") {
    const int bearings[] = {2617,   8726,   13089,  18325,  23212, 27750,
                            -28797, -23561, -18325, -13439, -8726, -2617};
    for (int i = 0; i < kRabSensors; ++i) {
        const auto reading = rab_reading(peaks({{i, 4095}}));
        CHECK(reading.bearing == bearings[i]);
        CHECK(reading.range == 4095);
        CHECK(reading.sensor == i);
    }
}

TEST_CASE("the published distance formula") {
    CHECK(rab_distance_cm(1074) == Approx(20).epsilon(0.01));
    CHECK(rab_distance_cm(829) == Approx(80).epsilon(0.01));
    CHECK(rab_distance_cm(1604 - 432.7, 0.0867438559) == Approx(1).epsilon(0.01));
}
