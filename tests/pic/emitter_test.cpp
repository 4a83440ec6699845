#include "emu/pic/emitter.h"

#include <catch2/catch.hpp>

using puckloop::pic::Emitter;

namespace {
constexpr double kTimeConstant = 295;  // 20 us
}

TEST_CASE("the reflected light rises and falls with the time constant") {
    Emitter emitter(kTimeConstant);
    CHECK(emitter.intensity(1000) == 0.0);
    emitter.set(true, 1000);
    CHECK(emitter.intensity(1000) == Approx(0.0));
    CHECK(emitter.intensity(1295) == Approx(1.0 - 0.36788).epsilon(1e-4));
    emitter.set(false, 20000);
    CHECK(emitter.intensity(20000) == Approx(1.0));
    CHECK(emitter.intensity(20295) == Approx(0.36788).epsilon(1e-4));
}

TEST_CASE("300 us after an edge the light has settled to less than a hundredth of a count") {
    Emitter emitter(kTimeConstant);
    emitter.set(true, 0);
    CHECK(4095 * (1.0 - emitter.intensity(4423)) < 0.01);
}

TEST_CASE("an edge in the middle of a rise goes on from where the light stands") {
    Emitter emitter(kTimeConstant);
    emitter.set(true, 0);
    const double before = emitter.intensity(200);
    emitter.set(false, 200);
    CHECK(emitter.intensity(200) == Approx(before));
    CHECK(emitter.intensity(150) ==
          Approx(before));    // a late question about the past is answered at the edge
    emitter.set(false, 300);  // no edge, nothing changes
    CHECK(emitter.intensity(200) == Approx(before));
}
