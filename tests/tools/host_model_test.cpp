// What a run would take on many machines: its limits, by hand.

#include "tools/mpi/host_model.h"

#include <catch2/catch.hpp>

#include <string>

using namespace puckloop::tools;

TEST_CASE("two measured runs are met by the model of them") {
    const HostModel model = host_model({5, 0.5, 1.0, 1000}, {20, 5.0, 4.0, 3000});
    CHECK(model.conductor_per_robot.at(5) == Approx(0.1));
    CHECK(model.conductor_per_robot.at(20) == Approx(0.25));
    CHECK(model.boards_per_robot == Approx(0.2));
    CHECK(model.waits.at(5) == Approx(1000));
    CHECK(model.waits.at(20) == Approx(3000));
}

TEST_CASE("no cost falls with more robots, or below none") {
    const HostModel falling = host_model({5, 1.0, 1.0, 1000}, {20, 2.0, 4.0, 500});
    CHECK(falling.conductor_per_robot.slope == 0.0);
    CHECK(falling.waits.at(2000) == Approx(750));
    const HostModel steep = host_model({5, 0.05, 1.0, 10}, {20, 4.0, 4.0, 1000});
    CHECK(steep.conductor_per_robot.at(0) == 0.0);
    CHECK(steep.conductor_per_robot.at(20) == Approx(0.2));
}

TEST_CASE("the limit is named, and more of what does not limit gains nothing") {
    // 100 robots: boards 20 s on one core, 0.1 s on 200; conductor 1 s; 10,000 waits.
    const HostModel model{{0.01, 0.0}, 0.2, {10000, 0.0}};
    const HostEstimate few = estimate(model, 100, 1, 4, 1e-6);
    CHECK(std::string(few.limit) == "boards");
    CHECK(few.real_time_factor == Approx(1 / (1.0 + 5.0)));
    const HostEstimate many = estimate(model, 100, 8, 16, 1e-6);
    CHECK(std::string(many.limit) == "conductor");
    CHECK(many.real_time_factor ==
          Approx(1 / (1.0 + 0.2)));  // a robot's boards take turns: 100 cores at most
    CHECK(estimate(model, 100, 32, 16, 1e-6).real_time_factor == Approx(many.real_time_factor));
    const HostEstimate slow = estimate(model, 100, 32, 16, 1e-3);
    CHECK(std::string(slow.limit) == "latency");
    CHECK(slow.real_time_factor == Approx(1 / 11.0));
}
