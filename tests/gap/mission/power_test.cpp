// How many runs a comparison is said to need, against experiments of which that is known.

#include "base/error.h"
#include "base/random.h"
#include "gap/mission/power.h"
#include "gap/stats/rate.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::mission;

namespace {

/// Two programs under "as it is" and two effects, which move the statistics by so many deviations.
MissionRuns experiment(double shift, std::size_t runs) {
    MissionRuns all{"drawn", {{"a", "m"}, {"b", "m"}, {"c", "m"}}, {"p", "q"}, {"as it is", "up", "down"}, {},
                    0};
    RandomStream random(11, "experiment");
    const double effects[3][3] = {{0, 0, 0}, {1, 0.5, 0}, {0, -0.5, -1}};
    for (const std::string& program : all.programs)
        for (std::size_t c = 0; c < 3; ++c)
            for (std::size_t i = 0; i < runs; ++i) {
                Run run{program, all.conditions[c], fmt::format("{}", i), {}};
                const double own = program == "p" ? 1.0 : 0.8;
                for (const double effect : effects[c])
                    run.values.push_back(3.0 + own * shift * effect + random.normal());
                all.runs.push_back(run);
            }
    return all;
}

PowerRequest small() {
    PowerRequest request;
    request.runs = {4, 16};
    request.cases = 30;
    return request;
}

}  // namespace

TEST_CASE("a strong effect is named by few runs, a weak one by none of these") {
    const Power strong = power_of(experiment(6.0, 24), small());
    REQUIRE(strong.curves.size() == 3);
    for (std::size_t effect = 0; effect < 2; ++effect) {
        INFO(strong.curves[effect].effect);
        CHECK(strong.curves[effect].points[1].right >= 27);
        CHECK(strong.curves[effect].points[1].wrong == 0);
    }
    const Power weak = power_of(experiment(0.2, 24), small());
    CHECK(weak.curves[0].points[0].right <= 6);
}

TEST_CASE("more runs name more, and nothing hidden stays nothing") {
    const Power power = power_of(experiment(1.5, 40), small());
    for (std::size_t effect = 0; effect < 2; ++effect)
        CHECK(power.curves[effect].points[1].right > power.curves[effect].points[0].right);
    const PowerCurve& nothing = power.curves.back();
    CHECK(nothing.effect.empty());
    for (const PowerPoint& point : nothing.points) {
        CHECK(point.same >= 25);
        CHECK(point.right + point.wrong + point.open == point.cases);
    }
}

TEST_CASE("the same experiment and seed give the same curves, by text, rows and picture") {
    const MissionRuns runs = experiment(2.0, 10);
    PowerRequest request = small();
    request.cases = 5;
    const Power a = power_of(runs, request), b = power_of(runs, request);
    CHECK(power_csv(a) == power_csv(b));
    CHECK(power_svg(a) == power_svg(b));
    CHECK_THAT(power_text(a), Catch::Contains("up") && Catch::Contains("(nothing hidden)"));
    request.seed = 2;
    CHECK(power_csv(power_of(runs, request)) != power_csv(a));
}

TEST_CASE("an experiment without effects, or with too few runs, has no power to be asked for") {
    MissionRuns one = experiment(1.0, 8);
    one.conditions.resize(1);
    CHECK_THROWS_WITH(power_of(one, small()), Catch::Contains("one condition"));
    CHECK_THROWS_WITH(power_of(experiment(1.0, 3), small()), Catch::Contains("has 3 runs"));
    MissionRuns single = experiment(1.0, 8);
    single.programs = {"p"};
    PowerRequest two = small();
    two.runs = {2, 8};
    CHECK_THROWS_WITH(power_of(single, two), Catch::Contains("2 runs of one program"));
}

TEST_CASE("limits of a share are Clopper and Pearson's") {
    CHECK(rate_of(0, 10).low == 0.0);
    CHECK(rate_of(0, 10).high == Approx(0.3085).epsilon(1e-3));
    CHECK(rate_of(8, 10).low == Approx(0.4439).epsilon(1e-3));
    CHECK(rate_of(8, 10).high == Approx(0.9748).epsilon(1e-3));
    CHECK(rate_of(10, 10).high == 1.0);
}
