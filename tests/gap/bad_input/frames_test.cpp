// Trackers that tell poses at frames of their own are found and put right; noise, wheels out of round and
// clocks that drift are not taken for them.

#include "gap/frames.h"

#include <catch2/catch.hpp>

#include "clocked_drive.h"

#include "gap/clocks.h"

using namespace puckloop::gap;
using namespace puckloop::gap::test;

namespace {

/// Frames of 20 ms, told to rows of 100 ms from frames that are 1/`beat` s out of step.
Run framed(const std::string& name, double beat, double phase) {
    return drive(
        name,
        [=](double t) {
            const double turns = beat * t + phase;
            return 0.02 * (turns - std::floor(turns) - 0.5);
        },
        0.01);
}

/// Deviation between the times at which counters are read and those of the frames, s, over the inner rows.
double misread(const Run& run, double beat, double phase) {
    double squares = 0.0, count = 0.0;
    for (std::size_t i = 0; i < run.rows; ++i) {
        const double t = run.column("t_s")[i], turns = beat * t + phase;
        const double late = 0.02 * (turns - std::floor(turns) - 0.5);
        const double error = run.counted_at[i] - (t - late);
        squares += error * error;
        count += 1.0;
    }
    return std::sqrt(squares / count);
}

}  // namespace

TEST_CASE("frames of a tracker's own are found, each run its beat, and counters read at their times") {
    Experiment e = of({framed("a", 1.313, 0.2), framed("b", 0.871, 0.9), framed("c", 4.77, 0.5)});
    const auto beats = frame_beats(e);
    REQUIRE(beats.size() == 3);
    const double beat[] = {1.313, 0.871, 4.77};
    for (std::size_t r = 0; r < 3; ++r) {
        INFO("run " << r);
        CHECK(beats[r].clear);
        CHECK(beats[r].beat == Approx(beat[r]).margin(0.002));
        CHECK(beats[r].period == Approx(0.02).margin(0.002));
    }
    align_frames(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(e.cautions.front().find("ms apart") != std::string::npos);
    CHECK(e.cautions.front().find("3 of 3") != std::string::npos);
    // A sawtooth of 20 ms has a deviation of 5.8 ms.
    CHECK(misread(e.runs[0], 1.313, 0.2) < 2e-3);
    CHECK(misread(e.runs[1], 0.871, 0.9) < 2e-3);
    CHECK(misread(e.runs[2], 4.77, 0.5) < 2e-3);
}

TEST_CASE("frames faster than rows can tell seem to run backwards, and are put right all the same") {
    Experiment e = of({framed("a", 6.2, 0.0), framed("b", 6.9, 0.3)});
    const auto beats = frame_beats(e);
    CHECK(beats[0].period < 0);
    CHECK(beats[0].beat == Approx(3.8).margin(0.002));
    align_frames(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(misread(e.runs[0], 6.2, 0.0) < 2e-3);
}

TEST_CASE("noise, a wheel out of round and a drifting clock are no frames") {
    const auto steady = [](double) { return 0.0; };
    for (const double wobble : {0.0, 0.05}) {
        Experiment e = of({drive("a", steady, 0.01, wobble), drive("b", steady, 0.01, wobble)});
        align_frames(e);
        CHECK(e.cautions.empty());
        CHECK(e.runs[0].counted_at.empty());
    }
    const auto drifts = [](double t) { return 0.005 * (t - 30.0); };
    Experiment e = of({drive("a", drifts, 0.01), drive("b", drifts, 0.01)});
    align_clocks(e);
    REQUIRE(e.cautions.size() == 1);
    align_frames(e);
    CHECK(e.cautions.size() == 1);
}
