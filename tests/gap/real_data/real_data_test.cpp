// Published measurements, through importers and analysis: the essential points of each verdict
// (docs/gap_real_data.md), above all what must not be claimed. Needs the sets: PUCKLOOP_MEASURED names their
// folder.

#include "gap/importers/importers.h"
#include "gap/pipeline/analyse.h"
#include "gap/reading/read_experiment.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <optional>

using namespace puckloop;
using namespace puckloop::gap;
using Catch::Matchers::Contains;
namespace fs = std::filesystem;

namespace {

/// Empty if the sets are not there.
std::optional<Verdict> verdict_on(const char* set, const char* experiment) {
    const char* measured = std::getenv("PUCKLOOP_MEASURED");
    if (measured == nullptr) {
        WARN("skipped: PUCKLOOP_MEASURED is not set");
        return std::nullopt;
    }
    const fs::path out = tests::scratch_path("gap_real");
    fs::remove_all(out);
    importers::import_set(fs::path(measured) / set, "", out);
    Options options;
    options.threads = 2;
    const Verdict verdict = analyse(read_experiment(out / experiment), options);
    fs::remove_all(out);
    return verdict;
}

bool names(const Verdict& verdict, std::string_view effect) {
    for (const Cause& cause : verdict.causes)
        if (cause.name == effect) return true;
    return false;
}

std::string cautions_of(const Verdict& verdict) {
    std::string all;
    for (const std::string& caution : verdict.cautions)
        all += caution + "\n";
    return all;
}

const FittedParameter* parameter_of(const Verdict& verdict, std::string_view name) {
    for (const Cause& cause : verdict.causes)
        for (const FittedParameter& p : cause.parameters)
            if (p.name == name) return &p;
    return nullptr;
}

/// Of a cause, or of what comes nearest where nothing is named.
const FittedParameter* told(const Verdict& verdict, std::string_view name) {
    if (const FittedParameter* named = parameter_of(verdict, name)) return named;
    for (const Cause& cause : verdict.nearest)
        for (const FittedParameter& p : cause.parameters)
            if (p.name == name) return &p;
    return nullptr;
}

}  // namespace

TEST_CASE("trap: the strength table whose last line is a copy makes no far floor") {
    const auto v = verdict_on("argos3_epuck_rab", "argos3_epuck_rab");
    if (!v) return;
    CHECK(v->decision == Decision::NoEffect);
    CHECK_FALSE(names(*v, "far_floor"));
    CHECK_FALSE(v->heldout.gain);
    CHECK_THAT(cautions_of(*v), Contains("row 9") && Contains("repeats row 8") && Contains("left out"));
    CHECK_THAT(cautions_of(*v), Contains("one run only"));
    // The simulator's strength curve was made from this table.
    CHECK_THAT(cautions_of(*v), Contains("proves nothing"));
}

TEST_CASE("trap: bearing offsets that belong to the place are not named as one offset") {
    const auto v = verdict_on("roh_ir_bearing", "roh_ir_bearing");
    if (!v) return;
    CHECK(v->decision != Decision::Named);
    CHECK_FALSE((v->heldout.gain && v->heldout.high > 1));
    CHECK_THAT(cautions_of(*v), Contains("from placement to placement"));
}

TEST_CASE("durations of host loops: nothing is named from two runs of a sum that drifts") {
    for (const char* part : {"unifr_timing_pipuck", "unifr_timing_wifi"}) {
        const auto v = verdict_on("unifr_epuck2_timing", part);
        if (!v) return;
        INFO(part);
        CHECK(v->decision != Decision::Named);
        CHECK_FALSE(names(*v, "truncation"));  // the set does not say which frames were whole
        CHECK_THAT(cautions_of(*v), Contains("2 runs"));
    }
}

TEST_CASE("a box at a distance that nobody wrote down is not explained away") {
    const auto v = verdict_on("epuck1_box_bearing", "epuck1_box_bearing");
    if (!v) return;
    CHECK(v->decision == Decision::Unexplained);
    CHECK_FALSE(v->leftovers.empty());
    CHECK_FALSE(v->heldout.gain);
    CHECK_THAT(cautions_of(*v), Contains("distance_m was not measured but assumed"));
}

TEST_CASE("a Thymio's proximity sensors are no e-puck's: nothing is named, and its dead zone is seen") {
    const auto v = verdict_on("thymio_sensors_resilient-swarms", "thymio_proximity");
    if (!v) return;
    CHECK(v->decision == Decision::Unexplained);
    CHECK_FALSE(v->heldout.gain);
    // Its readings are 0 or above 1000.
    const FittedParameter* threshold = told(*v, "proximity.threshold");
    REQUIRE(threshold != nullptr);
    CHECK(threshold->value > 1000);
    CHECK(threshold->value < 1300);
    CHECK_THAT(cautions_of(*v), Contains("from placement to placement"));
}

TEST_CASE("a Thymio's accelerometer reads a tenth of 1 g ahead at rest") {
    const auto v = verdict_on("thymio_sensors_resilient-swarms", "thymio_accelerometer");
    if (!v) return;
    CHECK(v->decision != Decision::NoEffect);
    const FittedParameter* ahead = told(*v, "accelerometer.bias0");
    REQUIRE(ahead != nullptr);
    CHECK(ahead->low > 2.0);  // of about 22 counts a g
    CHECK(ahead->high < 2.5);
    CHECK_FALSE(names(*v, "vibration"));
}

TEST_CASE("a Thymio under motion capture: its marker lies beside the axle") {
    const auto v = verdict_on("thymio_ground_vicon_epfl", "thymio_vicon_motion");
    if (!v) return;
    CHECK(v->decision != Decision::NoEffect);
    const FittedParameter* aside = told(*v, "tracker.marker_y");
    REQUIRE(aside != nullptr);
    CHECK(aside->low > -0.0100);
    CHECK(aside->high < -0.0075);
    // Geared motors ramp: nothing slides.
    CHECK(told(*v, "inverse_friction") == nullptr);
}

TEST_CASE("free drives: the axle is longer and the wheels are smaller than the metadata say") {
    const auto v = verdict_on("optiodom_diffdrive", "optiodom_free");
    if (!v) return;
    CHECK_THAT(cautions_of(*v), Contains("run apart") && Contains("frames of its own, about 10 ms apart"));
    // What plain least squares say of the same rows: 201.8 mm (runs: 201.3-202.1), -0.27 % +- 0.02 %.
    const FittedParameter* axle = told(*v, "robot.axle_length");
    REQUIRE(axle != nullptr);
    CHECK(axle->value == Approx(0.2018).margin(0.0006));
    const FittedParameter* scale = told(*v, "wheel_scale");
    REQUIRE(scale != nullptr);
    CHECK(scale->value == Approx(-0.0027).margin(0.0004));
    // Every run's clock is its own: no delay of the tracker, above all none at the end of its range.
    CHECK(told(*v, "tracker.delay") == nullptr);
    CHECK(told(*v, "inverse_friction") == nullptr);
}

TEST_CASE(
    "the Thymio's right ground sensor reads higher than its left one, directions differ more than repeats") {
    const auto v = verdict_on("thymio_sensors_resilient-swarms", "thymio_ground");
    if (!v) return;
    REQUIRE(names(*v, "ground_gain"));
    const FittedParameter* right = parameter_of(*v, "ground.offset2");
    REQUIRE(right != nullptr);
    CHECK(right->low > 50);
    const FittedParameter* left = parameter_of(*v, "ground.offset0");
    REQUIRE(left != nullptr);
    CHECK(left->low < 0);
    CHECK(left->high > 0);
    CHECK(v->heldout.high < 1);
    CHECK_THAT(cautions_of(*v), Contains("from placement to placement"));
}

TEST_CASE("circles: the same robot has about the same axle") {
    const auto v = verdict_on("optiodom_diffdrive", "optiodom_circular");
    if (!v) return;
    CHECK_THAT(cautions_of(*v), Contains("frames of its own"));
    // What plain least squares say: one wheel 0.05 % smaller than the mean, the marker turned by 0.34 deg.
    CHECK(names(*v, "axle_length"));
    const FittedParameter* mismatch = told(*v, "wheel_mismatch");
    REQUIRE(mismatch != nullptr);
    CHECK(mismatch->value == Approx(-0.0005).margin(0.0002));
    const FittedParameter* angle = told(*v, "tracker.marker_angle");
    REQUIRE(angle != nullptr);
    CHECK(angle->value == Approx(-0.34 * 3.14159 / 180).margin(0.0006));
    const FittedParameter* axle = told(*v, "robot.axle_length");
    REQUIRE(axle != nullptr);
    CHECK(axle->value > 0.2015);
    CHECK(axle->value < 0.2030);
    CHECK(told(*v, "tracker.delay") == nullptr);
    CHECK(told(*v, "inverse_friction") == nullptr);
}

TEST_CASE(
    "drives whose tracker and counters were lined up by hand: their clocks run apart, and that is said") {
    const char* measured = std::getenv("PUCKLOOP_MEASURED");
    if (measured == nullptr) {
        WARN("skipped: PUCKLOOP_MEASURED is not set");
        return;
    }
    const fs::path out = tests::scratch_path("gap_real");
    fs::remove_all(out);
    importers::import_set(fs::path(measured) / "optiodom_diffdrive", "", out);
    importers::import_set(fs::path(measured) / "thymio_ground_vicon_epfl", "", out);
    const auto apart = [&](const char* name) {
        const Experiment experiment = read_experiment(out / name);
        for (const std::string& caution : experiment.cautions)
            if (caution.find("run apart") != std::string::npos)
                return !experiment.runs.front().counted_at.empty();
        return false;
    };
    CHECK(apart("optiodom_free"));
    CHECK(apart("optiodom_circular"));
    CHECK_FALSE(apart("thymio_vicon_motion"));
    fs::remove_all(out);
}
