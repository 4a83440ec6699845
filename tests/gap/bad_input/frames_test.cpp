// Trackers that tell poses at frames of their own are found and put right; noise, wheels out of round and
// clocks that drift are not taken for them.

#include "gap/sync/sync.h"

#include <catch2/catch.hpp>

#include "clocked_drive.h"

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::test;

namespace {

/// A sawtooth of `frame` s, `beat` times a second.
std::function<double(double)> sawtooth(double beat, double phase, double frame = 0.02) {
    return [=](double t) {
        const double turns = beat * t + phase;
        return frame * (turns - std::floor(turns) - 0.5);
    };
}

Run framed(const std::string& name, double beat, double phase) {
    return drive(name, sawtooth(beat, phase), 0.01);
}

/// Deviation between the times at which counters are read and those of the frames, s, over the inner rows.
double misread(const Run& run, double beat, double phase) {
    const auto late = sawtooth(beat, phase);
    double squares = 0.0;
    for (std::size_t i = 0; i < run.rows; ++i) {
        const double t = run.column("t_s")[i];
        squares += std::pow(run.counted_at[i] - (t - late(t)), 2);
    }
    return std::sqrt(squares / static_cast<double>(run.rows));
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
    align_times(e);
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
    align_times(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(misread(e.runs[0], 6.2, 0.0) < 2e-3);
}

TEST_CASE("frames count where half the runs have them, and they agree about the length") {
    const auto steady = [](double) { return 0.0; };
    Experiment half = of({framed("a", 1.313, 0.2), framed("b", 0.871, 0.9), drive("c", steady, 0.01),
                          drive("d", steady, 0.01)});
    align_times(half);
    REQUIRE(half.cautions.size() == 1);
    CHECK(half.cautions.front().find("2 of 4") != std::string::npos);
    CHECK(half.runs[2].counted_at == half.runs[2].column("t_s"));
    Experiment few = of({framed("a", 1.313, 0.2), drive("b", steady, 0.01), drive("c", steady, 0.01)});
    align_times(few);
    CHECK(few.cautions.empty());
    CHECK(few.runs[0].counted_at.empty());
}

TEST_CASE("rows that are late at random are no frames, nor is anything told of uneven rows") {
    Experiment jittery, uneven;
    for (const char* name : {"a", "b", "c", "d", "e", "f"}) {
        RandomStream random(7, std::string("frames test ") + name);
        jittery.runs.push_back(drive(
            name, [&](double) { return 0.08 * random.uniform(); }, 0.01));
        uneven.runs.push_back(drive(name, sawtooth(1 / 0.066, 0.0, 0.066), 0.01, 0.0, 0.8));
    }
    for (Experiment* one : {&jittery, &uneven}) {
        one->kind = Kind::Motion;
        align_times(*one);
        for (const std::string& caution : one->cautions)
            CHECK(caution.find("frames of its own") == std::string::npos);
    }
}

TEST_CASE("no beat is looked for over gaps that outlast the rows") {
    Experiment e = of({framed("a", 1.313, 0.2), framed("b", 0.871, 0.9)});
    for (Run& run : e.runs)
        for (std::size_t i = run.rows / 2; i < run.rows; ++i)
            run.columns["t_s"][i] += 6 * 86400;
    CHECK_FALSE(frame_beats(e).front().clear);
}

TEST_CASE("rows may be missing") {
    Experiment e = of({framed("a", 1.313, 0.2), framed("b", 0.871, 0.9)});
    for (Run& run : e.runs)
        for (std::size_t i = 0; i < run.rows; ++i)
            if (i % 7 == 3 || i % 11 == 5) run.columns["x_m"][i] = NAN;
    align_times(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(misread(e.runs[0], 1.313, 0.2) < 2e-3);
}

TEST_CASE("clocks that drift are put right beside frames") {
    const auto saw = sawtooth(1.313, 0.2);
    const auto late = [&](double t) { return saw(t) + 0.004 * (t - 30.0); };
    Experiment e = of({drive("a", late, 0.01), drive("b", late, 0.01)});
    align_times(e);
    REQUIRE(e.cautions.size() == 2);
    CHECK(e.cautions[0].find("frames of its own") != std::string::npos);
    CHECK(e.cautions[1].find("run apart") != std::string::npos);
    double worst = 0.0;
    const Run& run = e.runs[0];
    for (std::size_t i = 0; i < run.rows; i += 37)
        worst = std::max(worst,
                         std::abs(run.counted_at[i] - (run.column("t_s")[i] - late(run.column("t_s")[i]))));
    CHECK(worst < 0.025);  // a sawtooth's jump may be missed by a row
    CHECK(run.column("t_s")[0] - run.counted_at[0] == Approx(late(run.column("t_s")[0])).margin(0.006));
}

TEST_CASE("noise, a wheel out of round and a drifting clock are no frames") {
    const auto steady = [](double) { return 0.0; };
    for (const double wobble : {0.0, 0.05}) {
        Experiment e = of({drive("a", steady, 0.01, wobble), drive("b", steady, 0.01, wobble)});
        align_times(e);
        CHECK(e.cautions.empty());
        CHECK(e.runs[0].counted_at.empty());
    }
    const auto drifts = [](double t) { return 0.005 * (t - 30.0); };
    Experiment e = of({drive("a", drifts, 0.01), drive("b", drifts, 0.01)});
    align_times(e);
    REQUIRE(e.cautions.size() == 1);
    CHECK(e.cautions.front().find("run apart") != std::string::npos);
}
