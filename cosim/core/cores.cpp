#include "cosim/core/cores.h"

#include <sched.h>

#include <algorithm>
#include <mutex>

namespace puckloop::cosim {

namespace {
cpu_set_t all_cores;
thread_local bool on_one_core = false;
}  // namespace

std::uint32_t usable_cores() {
    cpu_set_t cores;
    if (sched_getaffinity(0, sizeof cores, &cores) != 0) return 1;
    return static_cast<std::uint32_t>(std::max(1, CPU_COUNT(&cores)));
}

void use_one_core(std::uint32_t core) {
    static std::once_flag once;
    std::call_once(once, [] { sched_getaffinity(0, sizeof all_cores, &all_cores); });
    if (core >= CPU_SETSIZE || !CPU_ISSET(core, &all_cores)) return;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(core, &one);
    if (sched_setaffinity(0, sizeof one, &one) == 0) on_one_core = true;
}

void use_all_cores() {
    use_all_cores_in_child();
    on_one_core = false;
}

void use_all_cores_in_child() {
    if (on_one_core) sched_setaffinity(0, sizeof all_cores, &all_cores);
}

}  // namespace puckloop::cosim
