#pragma once
// The lists of what can be hidden, one a kind of experiment (effects_<kind>.cpp).

#include "gap/selftest/bench.h"
#include "gap/selftest/rigs.h"

#include <memory>

namespace puckloop::gap::selftest {

std::unique_ptr<Bench> motion_bench();
std::unique_ptr<Bench> proximity_bench();
std::unique_ptr<Bench> rab_bench();
std::unique_ptr<Bench> microphone_bench();
std::unique_ptr<Bench> ground_bench();
std::unique_ptr<Bench> accelerometer_bench();
std::unique_ptr<Bench> timing_bench();

}  // namespace puckloop::gap::selftest
