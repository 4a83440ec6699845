#include "base/random.h"
#include "gap/models/motion_path.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

double rms(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value * value;
    return std::sqrt(sum / static_cast<double>(values.size()));
}

struct Drive {
    std::vector<double> time, above;
};

/// Noise of 0.01 rad about `slope` rad/s, rows 0.1 s apart but for a gap.
Drive drive(double slope) {
    RandomStream random(4, "test/steadied heading");
    Drive drive;
    for (int i = 0; i < 400; ++i) {
        const double t = 0.1 * i + (i > 150 ? 3.0 : 0.0);
        drive.time.push_back(t);
        drive.above.push_back(0.01 * random.normal() + slope * t);
    }
    return drive;
}

}  // namespace

TEST_CASE("over a long span all that scatters about a run's mean is the tracker's", "[gap]") {
    const Drive still = drive(0.0);
    std::vector<double> errors;
    heading_errors(still.above, still.time, 1e4, {}, errors);
    double mean = 0.0;
    for (const double above : still.above)
        mean += above / 400;
    for (std::size_t i = 0; i < errors.size(); ++i)
        CHECK(errors[i] == Approx(still.above[i] - mean).margin(1e-4));
}

TEST_CASE("over a short span nothing is", "[gap]") {
    const Drive still = drive(0.0);
    std::vector<double> errors;
    heading_errors(still.above, still.time, 1e-2, {}, errors);
    CHECK(rms(errors) < 1e-4);
}

TEST_CASE("a robot that turns away from its wheels is followed over a middling span, not over a long one",
          "[gap]") {
    const Drive turning = drive(0.05);
    std::vector<double> near, far;
    heading_errors(turning.above, turning.time, 0.5, {}, near);
    heading_errors(turning.above, turning.time, 1e3, {}, far);
    CHECK(rms(near) == Approx(0.01).epsilon(0.25));
    CHECK(rms(far) > 0.3);
}

TEST_CASE("a robot that is turned at once is followed from there on, and no further back", "[gap]") {
    Drive turned = drive(0.0);
    constexpr std::size_t kRow = 120;
    for (std::size_t i = kRow; i < turned.above.size(); ++i)
        turned.above[i] += 0.2;
    const std::vector<double> chance(turned.above.size(), 0.01), turn(turned.above.size(), 0.1);
    std::vector<double> kept, errors;
    kept_headings(turned.above, {chance, turn, {}}, kept);
    CHECK(kept[kRow] < 1e-6);
    CHECK(std::ranges::count_if(kept, [](double one) { return one < 0.5; }) == 1);
    heading_errors(turned.above, turned.time, 1e3, kept, errors);
    CHECK(rms(errors) == Approx(0.01).epsilon(0.1));
    heading_errors(turned.above, turned.time, 1e3, {}, errors);
    CHECK(rms(errors) > 0.08);
}

TEST_CASE("no heading is lost where nothing turned", "[gap]") {
    const Drive still = drive(0.0);
    std::vector<double> kept;
    const std::vector<double> turn(400, 0.1);
    kept_headings(still.above, {std::vector(400, 0.0), turn, std::vector(400, 0.0)}, kept);
    CHECK(std::ranges::all_of(kept, [](double one) { return one == 1.0; }));
    const std::vector<double> constant(400, 0.3);
    kept_headings(constant, {std::vector(400, 0.01), turn, {}}, kept);
    CHECK(std::ranges::all_of(kept, [](double one) { return one > 0.99; }));
    kept_headings({}, {}, kept);
    CHECK(kept.empty());
}

TEST_CASE("a heading that gains a variance in some rows is followed there", "[gap]") {
    Drive walking = drive(0.0);
    std::vector<double> variance(walking.above.size(), 0.0), kept, errors;
    RandomStream random(9, "test/steadied heading/walk");
    double off = 0.0;
    for (std::size_t i = 0; i < walking.above.size(); ++i) {
        if (i % 40 == 0) variance[i] = 0.05 * 0.05, off += 0.05 * random.normal();
        walking.above[i] += off;
    }
    kept_headings(walking.above, {{}, {}, variance}, kept);
    CHECK(kept[39] == 1.0);
    CHECK(kept[40] < 0.01);
    heading_errors(walking.above, walking.time, 1e3, kept, errors);
    CHECK(rms(errors) == Approx(0.01).epsilon(0.1));
}
