#include "cosim/remote/processes/core_choice.h"

#include "cosim/core/cores.h"

#include <sched.h>

namespace puckloop::cosim {

namespace {

// All cores are what the machine's own scheduler would take.
constexpr Trial::Rule kRule{
    .slices = 16, .slice = 0.005, .margin = 1.1, .first_hold = 0.5, .longest_hold = 8.0};

}  // namespace

CoreFollower::~CoreFollower() {
    use_all_cores();
}

void CoreFollower::move(std::uint32_t core) {
    core_ = core;
    use_all_cores();
    if (core != kAnyCore) use_one_core(core - 1);
}

CoreChoice::CoreChoice(Busy& busy)
    : busy_(busy), follower_(busy), worth_it_(usable_cores() > 1), trial_(kRule) {}

void CoreChoice::use(bool one_core) {
    one_core_ = one_core;
    const int core = one_core ? sched_getcpu() : -1;
    busy_.core.store(core < 0 ? kAnyCore : static_cast<std::uint32_t>(core) + 1, std::memory_order_relaxed);
    follower_.follow();
}

void CoreChoice::step(double wall, Time time, std::uint64_t grants) {
    if (!worth_it_) return;
    if (const bool one_core = trial_.step(wall, time, grants); one_core != one_core_) use(one_core);
}

}  // namespace puckloop::cosim
