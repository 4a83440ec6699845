// Clocks of tracker and counters that run apart are found and put right; robots that are merely wrong are not
// taken for it.

#include "gap/sync/sync.h"

#include <catch2/catch.hpp>

#include "clocked_drive.h"

using namespace puckloop::gap;
using namespace puckloop::gap::test;

namespace {

/// Lateness that grows by `drift` from the first row to the last, in the middle `late` (s).
Run drifting(const std::string& name, double late, double drift, double axle_error) {
    return drive(
        name, [=](double t) { return late + drift * ((t - kBegins) / (kLasts - kBegins) - 0.5); },
        axle_error);
}

}  // namespace

TEST_CASE("lateness and its drift are found, each run its own") {
    Experiment e =
        of({drifting("a", 0.05, 0.3, 0.01), drifting("b", -0.1, 0.2, 0.01), drifting("c", 0.3, -0.2, 0.01)});
    align_clocks(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(e.cautions.front().find("run apart") != std::string::npos);
    const double late[] = {0.05, -0.1, 0.3}, drift[] = {0.3, 0.2, -0.2};
    for (std::size_t r = 0; r < 3; ++r) {
        const Run& run = e.runs[r];
        REQUIRE(run.counted_at.size() == run.rows);
        const auto correction = [&](std::size_t i) { return run.column("t_s")[i] - run.counted_at[i]; };
        // Over the run the correction grows by the drift.
        CHECK(correction(run.rows - 1) - correction(0) == Approx(drift[r]).margin(0.03));
        // Of lateness that differs from run to run nothing is left to a tracker that is late.
        CHECK(correction(run.rows / 2) == Approx(late[r]).margin(0.02));
    }
}

TEST_CASE("a lateness that runs with drifting clocks have in common is left to the tracker's delay") {
    Experiment e =
        of({drifting("a", 0.2, 0.3, 0.01), drifting("b", 0.21, 0.2, 0.01), drifting("c", 0.19, -0.2, 0.01)});
    align_clocks(e);
    REQUIRE(e.cautions.size() == 1);
    const Run& run = e.runs[0];
    REQUIRE(run.counted_at.size() == run.rows);
    const double late_in_the_middle = run.column("t_s")[run.rows / 2] - run.counted_at[run.rows / 2];
    CHECK(late_in_the_middle == Approx(0.0).margin(0.02));
}

TEST_CASE("a robot of other numbers and a tracker that is always late are no clocks that run apart") {
    Experiment e =
        of({drifting("a", 0.1, 0.0, 0.03), drifting("b", 0.1, 0.0, 0.03), drifting("c", 0.1, 0.0, 0.03)});
    align_clocks(e);
    CHECK(e.cautions.empty());
    CHECK(e.runs[0].counted_at.empty());
}
