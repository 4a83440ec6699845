#include "base/random.h"
#include "gap/models/motion_path.h"

#include <catch2/catch.hpp>

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
    heading_errors(still.above, still.time, 1e4, errors);
    double mean = 0.0;
    for (const double above : still.above)
        mean += above / 400;
    for (std::size_t i = 0; i < errors.size(); ++i)
        CHECK(errors[i] == Approx(still.above[i] - mean).margin(1e-4));
}

TEST_CASE("over a short span nothing is", "[gap]") {
    const Drive still = drive(0.0);
    std::vector<double> errors;
    heading_errors(still.above, still.time, 1e-2, errors);
    CHECK(rms(errors) < 1e-4);
}

TEST_CASE("a robot that turns away from its wheels is followed over a middling span, not over a long one",
          "[gap]") {
    const Drive turning = drive(0.05);
    std::vector<double> near, far;
    heading_errors(turning.above, turning.time, 0.5, near);
    heading_errors(turning.above, turning.time, 1e3, far);
    CHECK(rms(near) == Approx(0.01).epsilon(0.25));
    CHECK(rms(far) > 0.3);
}
