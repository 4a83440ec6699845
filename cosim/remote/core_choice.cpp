#include "cosim/remote/core_choice.h"

#include "cosim/core/cores.h"

#include <sched.h>

#include <algorithm>

namespace puckloop::cosim {

namespace {

// A trial: slices of wall seconds, on all cores and on one in turn as in A B B A.
constexpr int kSlices = 16;
constexpr double kSlice = 0.005;
// What was chosen is held so long, and longer each time it is chosen again.
constexpr double kFirstHold = 0.5, kLongestHold = 8.0;
// One core must be better by so much: all of them are what the machine's own scheduler would take.
constexpr double kMargin = 1.1;

bool on_one_core_in_trial(int slice) {
    return slice % 4 == 1 || slice % 4 == 2;
}

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
    : busy_(busy), follower_(busy), worth_it_(usable_cores() > 1), slice_(kSlices) {}

/// How fast it went. Where nodes chatter a grant takes little simulated and little wall time, where they work
/// much of both: the product of the two rates does not depend on which stretch a slice met.
double CoreChoice::Progress::rate() const {
    return wall > 0 ? time * grants / (wall * wall) : 0;
}

void CoreChoice::use(bool one_core) {
    one_core_ = one_core;
    const int core = one_core ? sched_getcpu() : -1;
    busy_.core.store(core < 0 ? kAnyCore : static_cast<std::uint32_t>(core) + 1, std::memory_order_relaxed);
    follower_.follow();
}

void CoreChoice::step(double wall, Time time, std::uint64_t grants) {
    if (!worth_it_ || wall < until_) return;
    const Progress now{wall, to_seconds(time), static_cast<double>(grants)};
    if (slice_ < kSlices) {
        Progress& tried = tried_[one_core_];
        tried.wall += now.wall - before_.wall;
        tried.time += now.time - before_.time;
        tried.grants += now.grants - before_.grants;
        ++slice_;
    } else {
        slice_ = 0;
        tried_[0] = tried_[1] = {};
    }
    before_ = now;
    if (slice_ == kSlices) {
        choose();
        until_ = wall + hold_;
    } else {
        use(on_one_core_in_trial(slice_));
        until_ = wall + kSlice;
    }
}

void CoreChoice::choose() {
    const bool better = tried_[1].rate() > kMargin * tried_[0].rate();
    hold_ = better == chosen_ ? std::clamp(2 * hold_, kFirstHold, kLongestHold) : kFirstHold;
    chosen_ = better;
    use(better);
}

}  // namespace puckloop::cosim
