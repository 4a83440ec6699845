// Two robots in one file and no column that says so.

#include "tests/gap/bad_input/made_experiment.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;
using Catch::Matchers::Contains;

namespace {

/// A robot on a circle, seen each 0.1 s; `pose` of each row and how it is told is the test's.
using Pose = std::function<void(std::size_t i, double& x, double& y, RandomStream& random)>;

Made circles(const Pose& pose, const char* wheels = "cmd") {
    Made made{"motion", {"t_s", std::string(wheels) + "_left", std::string(wheels) + "_right"}, {}, "", 2};
    for (const char* name : {"x_m", "y_m", "theta_rad"})
        made.names.emplace_back(name);
    RandomStream random(1, "gap/mixed");
    const double metre = 2 * std::numbers::pi * 0.0205 / 1000, turn = 200 * 0.1 * metre / 0.053;
    for (std::size_t i = 0; i < 120; ++i) {
        const double k = static_cast<double>(i), theta = turn * k, radius = 30 * metre / turn;
        double x = radius * std::sin(theta), y = radius * (1 - std::cos(theta));
        pose(i, x, y, random);
        const bool told = std::string_view(wheels) == "cmd";
        made.rows.push_back({fmt::format("{:.1f}", 0.1 * k), told ? "200" : fmt::format("{}", 20 * i),
                             told ? "400" : fmt::format("{}", 40 * i),
                             fmt::format("{:.4f}", x + 3e-4 * random.normal()),
                             fmt::format("{:.4f}", y + 3e-4 * random.normal()),
                             fmt::format("{:.4f}", theta + 2e-3 * random.normal())});
    }
    return made;
}

/// Readings of four sensors at six distances, ten times each; `factor` of the i-th time.
Made shelf(const std::function<double(std::size_t i, RandomStream& random)>& factor) {
    Made made{"proximity", {"t_s", "sensor", "distance_m", "reading"}, {}, "", 2};
    RandomStream random(2, "gap/mixed");
    double t = 0;
    for (const double mm : {10, 15, 20, 30, 40, 60})
        for (std::size_t i = 0; i < 10; ++i)
            for (int sensor = 0; sensor < 4; ++sensor, t += 0.1)
                made.rows.push_back(
                    {fmt::format("{:.1f}", t), fmt::format("{}", sensor),
                     fmt::format("{}", mm / 1000 + 1e-6 * random.normal()),
                     fmt::format("{:.0f}", factor(i, random) * 1.05e5 / (mm * mm) + 4 * random.normal())});
    return made;
}

}  // namespace

TEST_CASE("poses of two robots in one file are refused, however their rows lie") {
    const auto beside = [](double& x, double& y) { x += 0.15, y += 0.1; };
    for (const char* wheels : {"cmd", "steps"}) {
        INFO(wheels);
        CHECK_THAT(refusal(circles(
                       [&](std::size_t i, double& x, double& y, RandomStream&) {
                           if (i % 2 == 1) beside(x, y);
                       },
                       wheels)),
                   Contains("row 2") && Contains("two robots"));
        CHECK_THAT(refusal(circles(
                       [&](std::size_t, double& x, double& y, RandomStream& random) {
                           if (random.uniform() < 0.3) beside(x, y);
                       },
                       wheels)),
                   Contains("two robots"));
        CHECK_THAT(refusal(circles(
                       [&](std::size_t i, double& x, double& y, RandomStream&) {
                           if (i / 8 % 2 == 1) beside(x, y);
                       },
                       wheels)),
                   Contains("row 9") && Contains("two robots"));
    }
}

TEST_CASE("one robot seen badly, carried away or seen from time to time is not taken for two") {
    CHECK(refusal(circles([](std::size_t, double&, double&, RandomStream&) {})) == "");
    // A tracker that is wildly wrong now and then, anywhere.
    CHECK(refusal(circles([](std::size_t, double& x, double& y, RandomStream& random) {
              if (random.uniform() < 0.12) x += 0.3 * random.normal(), y += 0.3 * random.normal();
          })) == "");
    // Put elsewhere, and back.
    CHECK(refusal(circles([](std::size_t i, double& x, double&, RandomStream&) {
              if (i > 40 && i < 80) x += 0.3;
          })) == "");
    Made mixed = circles([](std::size_t i, double& x, double&, RandomStream&) { x += i % 2 == 1 ? 0.2 : 0; });
    mixed.names.insert(mixed.names.begin(), "unit");
    for (std::size_t i = 0; i < mixed.rows.size(); ++i)
        mixed.rows[i].insert(mixed.rows[i].begin(), i % 2 == 1 ? "2" : "1");
    CHECK_THAT(refusal(mixed), !Contains("two robots"));  // it was said
}

TEST_CASE("readings of two robots in one file are said") {
    const auto cautions = [](const Made& made) {
        std::string all;
        CHECK(refusal(made, &all) == "");
        return all;
    };
    CHECK_THAT(cautions(shelf([](std::size_t i, RandomStream&) { return i % 2 == 1 ? 1.25 : 1.0; })),
               Contains("two levels") && Contains("unit"));
    CHECK_THAT(cautions(shelf(
                   [](std::size_t, RandomStream& random) { return random.uniform() < 0.5 ? 1.25 : 1.0; })),
               Contains("two levels"));
    const auto quiet = [&](const std::function<double(std::size_t, RandomStream&)>& factor) {
        CHECK_THAT(cautions(shelf(factor)), !Contains("two levels"));
    };
    quiet([](std::size_t, RandomStream&) { return 1.0; });
    quiet([](std::size_t, RandomStream& random) { return 1 + 0.1 * random.normal(); });
    quiet([](std::size_t i, RandomStream&) { return i < 5 ? 1.0 : 1.25; });  // something moved, once
    quiet([](std::size_t, RandomStream& random) { return random.uniform() < 0.1 ? 1.5 : 1.0; });
}

TEST_CASE("frames of two robots in one file are refused or said") {
    const auto frames = [](auto seq, double period) {
        Made made{"timing", {"seq", "t_host_s", "nominal_period"}, {}, "", 2};
        RandomStream random(3, "gap/mixed");
        for (int i = 0; i < 80; ++i)
            made.rows.push_back({fmt::format("{}", seq(i)),
                                 fmt::format("{:.6f}", period * i + 2e-4 * random.normal()), "0.1"});
        return made;
    };
    CHECK_THAT(refusal(frames([](int i) { return i / 2; }, 0.05)), Contains("seq does not count on"));
    CHECK_THAT(refusal(frames([](int i) { return i / 2 + i % 2 * 500; }, 0.05)),
               Contains("seq does not count on (1 after 500"));
    CHECK(refusal(frames([](int i) { return i; }, 0.1)) == "");
    CHECK(refusal(frames([](int i) { return (i + 200) % 256; }, 0.1)) == "");  // a counter of eight bits
    Made made = frames([](int i) { return i; }, 0.05);
    made.names.erase(made.names.begin());
    for (auto& row : made.rows)
        row.erase(row.begin());
    std::string cautions;
    CHECK(refusal(made, &cautions) == "");
    CHECK_THAT(cautions, Contains("frames come every 0.05 s"));
}
