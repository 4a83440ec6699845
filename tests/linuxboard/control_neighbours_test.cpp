// From packets to neighbours: distance by the published curve, calibration, averaging, delivery report.

#include "linuxboard/control/behaviours/calibrate.h"
#include "linuxboard/control/behaviours/neighbours.h"
#include "tests/linuxboard/simulated_rab.h"

#include <catch2/catch.hpp>

using namespace puckloop::control;

TEST_CASE("strength becomes distance as the published table has it") {
    // fact sheet 5.1: medians and the distances it gives for them with gain 1, rounded there to 0.1 cm
    CHECK(range_cm(1407, 1) == Approx(3.0).margin(0.06));
    CHECK(range_cm(1193, 1) == Approx(10.2).margin(0.06));
    CHECK(range_cm(1010, 1) == Approx(28.7).margin(0.06));
    CHECK(range_cm(919, 1) == Approx(48.0).margin(0.06));
    CHECK(range_cm(1074, 1) == Approx(20).margin(0.06));
    CHECK(range_cm(1074 - 432.7, 0.0867438559) == Approx(20).margin(0.06));
}

TEST_CASE("calibration takes 100 messages of others with a direction") {
    RangeCalibration calibration(100, 7);
    CHECK_FALSE(calibration.add(7, 0.3, 900));
    CHECK_FALSE(calibration.add(0, 0.3, 900));
    CHECK_FALSE(calibration.add(3, 0, 900));
    for (int i = 0; i < 99; ++i)
        CHECK(calibration.add(3, -0.3, i % 2 == 0 ? 600 : 620));
    CHECK_FALSE(calibration.gain());
    CHECK(calibration.add(4, 1, 620));
    CHECK_FALSE(calibration.add(4, 1, 620));
    CHECK(calibration.mean_strength() == 610);
    CHECK(calibration.deviation() == Approx(10.05).margin(0.01));
    CHECK(range_cm(610, *calibration.gain()) == Approx(20));
}

TEST_CASE("a calibration run polls until it has all messages, or gives up") {
    SimulatedClock clock;
    SimulatedRab device(clock);
    RabBoard board(device, clock, {});
    int answered = 0;
    const auto feed = [&] {  // asked once a round
        device.receive({.data = 0x0005, .bearing = -200, .strength = 700});
        device.receive({.data = 0x0009, .bearing = 200, .strength = 100});  // own
        return ++answered > 10000;
    };
    const CalibrationSettings settings{.messages = 50, .own_id = 9};
    const RangeCalibration done = calibrate_range(board, clock, feed, settings);
    REQUIRE(done.gain());
    CHECK(done.mean_strength() == 700);
    CHECK(clock.time < 3);
    const double begun = clock.time;
    const auto silent = [] { return false; };
    CHECK_FALSE(calibrate_range(board, clock, silent, {.messages = 50, .own_id = 9, .duration = 5}).gain());
    CHECK(clock.time - begun == Approx(5).margin(0.05));
}

TEST_CASE("neighbours are kept by id, averaged, and forgotten after a second") {
    Neighbourhood around(1);
    const std::vector<RabPacket> first{{.payload = 0x0A02, .bearing = 3.1, .strength = 1000, .time = 10.0},
                                       {.payload = 0x0001, .bearing = 1, .strength = 1000, .time = 10.0},
                                       {.payload = 0x0000, .bearing = 1, .strength = 1000, .time = 10.0},
                                       {.payload = 0x0B07, .bearing = -1, .strength = 1193, .time = 10.0}};
    around.update(10.0, first);
    std::vector<Neighbour> list = around.list(10.0);
    REQUIRE(list.size() == 2);
    CHECK(list[0].id == 2);
    CHECK(list[0].data == 0x0A);
    CHECK(list[0].bearing == Approx(3.1));
    CHECK(list[1].id == 7);
    CHECK(list[1].range_cm == Approx(10.2).margin(0.1));

    std::vector<RabPacket> more;  // straight behind, from both sides: the mean is behind, not ahead
    for (int i = 1; i <= 40; ++i)
        more.push_back({.payload = 0x0C02,
                        .bearing = i % 2 == 0 ? 3.1 : -3.1,
                        .strength = i % 2 == 0 ? 900.0 : 1100.0,
                        .time = 10 + 0.02 * i});
    around.update(10.9, more);
    list = around.list(10.9);
    REQUIRE(list.size() == 2);
    CHECK(std::abs(list[0].bearing) > 3.1);
    CHECK(list[0].range_cm == Approx(range_cm(1000, 1)).epsilon(0.05));
    CHECK(list[0].age == Approx(0.1));
    around.update(11.2, {});
    CHECK(around.list(11.2).size() == 1);
    around.update(12.0, {});
    CHECK(around.list(12.0).empty());
}

TEST_CASE("the report counts messages of each neighbour and second") {
    Neighbourhood around(1);
    CHECK(around.delivery(5.0).empty());
    std::vector<RabPacket> packets(33, {.payload = 0x02, .bearing = 1, .strength = 1193, .time = 5.5});
    packets.resize(38, {.payload = 0x09, .bearing = 1, .strength = 1010, .time = 5.6});
    around.update(5.6, packets);
    CHECK(around.delivery(5.9).empty());
    CHECK(around.delivery(6.0) == "messages a second: 2: 33 (10 cm), 9: 5 (29 cm)");
    CHECK(around.delivery(7.0) == "messages a second: none");
}
