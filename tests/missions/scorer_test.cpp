// The objective functions, against what they are by hand.

#include "missions/scorer.h"

#include <catch2/catch.hpp>

using namespace puckloop::missions;

namespace {

Region disc(double x, double y, double radius) {
    Region region;
    region.disc = true;
    region.x = x;
    region.y = y;
    region.radius = radius;
    return region;
}

Region rectangle(double x, double y, double length, double width) {
    Region region;
    region.x = x;
    region.y = y;
    region.length = length;
    region.width = width;
    return region;
}

void step(Scorer& scorer, const std::vector<Place>& robots) {
    scorer.step(robots);
}

}  // namespace

TEST_CASE("aggregation counts robots in the spot each step, or their share at the end") {
    Mission mission;
    mission.spots = {disc(0, 0.5, 0.25)};
    Scorer sum(mission);
    mission.at_end = true;
    Scorer share(mission);
    CHECK(sum.score() == 0.0);
    for (Scorer* scorer : {&sum, &share}) {
        step(*scorer, {{0, 0.5}, {0, 0.26}, {0, 0.24}});
        step(*scorer, {{0, 0}, {0, 0.75}, {1, 1}});
    }
    CHECK(sum.score() == 3.0);  // the edge counts
    CHECK(share.score() == Approx(1.0 / 3));
    CHECK(sum.steps() == 2);
}

TEST_CASE("foraging counts an item each time a robot comes to the nest after a spot") {
    Mission mission;
    mission.kind = Kind::Foraging;
    mission.spots = {disc(0.75, 0, 0.25), disc(-0.75, 0, 0.25)};
    mission.nest = rectangle(0, -1, 3, 0.8);  // y below -0.6
    Scorer scorer(mission);
    step(scorer, {{0, -1}, {0.75, 0}});  // nest without an item; an item taken
    CHECK(scorer.score() == 0.0);
    step(scorer, {{-0.75, 0}, {0, 0}});
    step(scorer, {{-0.75, 0}, {0, -0.7}});  // the second one brings it
    CHECK(scorer.score() == 1.0);
    step(scorer, {{0, -0.61}, {0, -0.8}});  // the first one; the second has nothing more
    CHECK(scorer.score() == 2.0);
    step(scorer, {{0, -0.61}, {0, -0.8}});
    CHECK(scorer.score() == 2.0);
}

TEST_CASE("grid exploration sums minus the mean age of the cells") {
    Mission mission;
    mission.kind = Kind::GridExploration;
    mission.area = rectangle(0, 0, 2, 2);
    mission.cells = 2;
    Scorer scorer(mission);
    step(scorer, {{-0.5, -0.5}});  // ages 0 1 1 1
    CHECK(scorer.score() == Approx(-0.75));
    step(scorer, {{1.0, 1.0}});  // ages 1 2 2 0; the area's edge is in the last cell
    CHECK(scorer.score() == Approx(-0.75 - 1.25));
    step(scorer, {{1.1, 0.0}});  // outside: ages 2 3 3 1
    CHECK(scorer.score() == Approx(-0.75 - 1.25 - 2.25));
}

TEST_CASE("coverage is the mean distance to the nearest robot that counts, at the end") {
    Mission mission;
    mission.kind = Kind::Coverage;
    mission.area = disc(0, 0, 1);
    Scorer scorer(mission);
    step(scorer, {{0.3, 0.3}});
    step(scorer, {{0, 0}});
    CHECK(scorer.score() ==
          Approx(2.0 / 3).epsilon(0.002));  // of a disc's points to its middle; lattice of 2 cm
    mission.spots = {disc(0.5, 0, 0.1)};
    Scorer forbidden(mission);
    step(forbidden, {{0, 0}, {0.5, 0}});
    CHECK(forbidden.score() == Approx(scorer.score()));
}
