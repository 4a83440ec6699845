// Arrivals that err to one side, as waits do: the law of an error is no effect, a course of its size or of
// its mean is.

#include "base/random.h"
#include "gap/pipeline/analyse.h"
#include "tests/gap/simulated.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdint>
#include <functional>

using namespace puckloop;
using namespace puckloop::gap;

namespace {

constexpr double kMillisecond = 1e-3;

/// Frames that each come late by `wait` seconds; `step`: of the host's clock, 0 for none.
Experiment frames(const std::function<double(RandomStream&, int frame)>& wait, std::uint64_t seed,
                  double step) {
    RandomStream random(seed, "waits/frames");
    double begun = 0.0;
    return test::recorded(Kind::Timing, 6, 300, [&](Run& run, int, int k) {
        if (k == 0) begun = 0.5 + random.uniform();
        const double robot = 0.1 * k, host = robot + begun + wait(random, k);
        run.columns["seq"].push_back(k);
        run.columns["t_robot_s"].push_back(robot);
        run.columns["t_host_s"].push_back(step > 0 ? std::round(host / step) * step : host);
        run.columns["bytes"].push_back(84);
    });
}

double exponential(RandomStream& random) {
    return -kMillisecond * std::log(1 - random.uniform());
}
double log_normal(RandomStream& random) {
    return kMillisecond * std::exp(0.7 * random.normal());
}

}  // namespace

TEST_CASE("waits of a skewed law are no effect, in whole milliseconds neither", "[gap][decision]") {
    const double step = GENERATE(0.0, kMillisecond);
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        INFO("seed " << seed << ", step " << step);
        CHECK(analyse(frames([](RandomStream& random, int) { return exponential(random); }, seed, step))
                  .decision == Decision::NoEffect);
        CHECK(analyse(frames([](RandomStream& random, int) { return log_normal(random); }, seed, step))
                  .decision == Decision::NoEffect);
    }
}

TEST_CASE("waits that lengthen as frames go by are unexplained", "[gap][decision]") {
    const auto wait = [](RandomStream& random, int frame) {
        return exponential(random) * (1 + 1.5 * std::sin(frame / 40.0));
    };
    CHECK(analyse(frames(wait, 1, 0.0)).decision == Decision::Unexplained);
}
