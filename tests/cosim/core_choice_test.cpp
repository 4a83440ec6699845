// On which cores a run's processes work: what goes faster is chosen, and nothing of it is left behind.

#include "cosim/core/cores.h"
#include "cosim/remote/processes/core_choice.h"

#include <catch2/catch.hpp>

#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

using namespace puckloop::cosim;

namespace {

int cores_of_this_thread() {
    cpu_set_t set;
    REQUIRE(sched_getaffinity(0, sizeof set, &set) == 0);
    return CPU_COUNT(&set);
}

/// Part of `seconds` that a run spends on one core where that is `factor` times as fast. Stretches of chatter
/// (many grants, little simulated time) and of work follow each other, longer than a slice of a trial.
double part_on_one_core(double factor, double seconds) {
    const int all = cores_of_this_thread();
    Busy busy{};
    CoreChoice choice(busy);
    double on_one = 0, time = 0, grants = 0;
    const double step = 0.0005;
    int step_number = 0;
    for (double wall = 0; wall < seconds; wall += step) {
        choice.step(wall, from_seconds(time), static_cast<std::uint64_t>(grants));
        const bool one = busy.core != kAnyCore;
        if (step_number++ % 64 == 0) CHECK(cores_of_this_thread() == (one ? 1 : all));
        if (one) on_one += step;
        const double speed = one ? factor : 1.0;
        const bool chatter = static_cast<int>(wall / 0.013) % 2 == 0;
        time += step * speed * (chatter ? 2.0 : 20.0);
        grants += step * speed * (chatter ? 50'000 : 5'000);
    }
    return on_one / seconds;
}

}  // namespace

TEST_CASE("a run stays on one core where that is faster, and only there") {
    const int before = cores_of_this_thread();
    if (before > 1) {
        CHECK(part_on_one_core(1.5, 8.0) > 0.7);
        CHECK(part_on_one_core(1.0, 8.0) < 0.3);
        CHECK(part_on_one_core(0.6, 8.0) < 0.3);
    } else {
        CHECK(part_on_one_core(1.5, 1.0) == 0);
    }
    CHECK(cores_of_this_thread() == before);
}

TEST_CASE("a process that is made on one core may use all of them") {
    const int before = cores_of_this_thread();
    Busy busy{};
    CoreFollower follower(busy);
    busy.core = static_cast<std::uint32_t>(sched_getcpu()) + 1;
    follower.follow();
    CHECK(cores_of_this_thread() == 1);
    const pid_t child = fork();
    if (child == 0) {
        use_all_cores_in_child();
        cpu_set_t set;
        sched_getaffinity(0, sizeof set, &set);
        _exit(CPU_COUNT(&set));
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WEXITSTATUS(status) == before);
    busy.core = kAnyCore;
    follower.follow();
    CHECK(cores_of_this_thread() == before);
    busy.core = 77'777;  // nonsense is no core
    follower.follow();
    CHECK(cores_of_this_thread() == before);
}
