// What the host's kernel knows of its machine and would change from run to run: how long it is up, its load,
// its memory, the processor that executes.

#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/machine/machine_state.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <sched.h>
#include <stdlib.h>
#include <sys/sysinfo.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>

extern "C" int __gethostname_chk(char*, size_t, size_t) noexcept;
extern "C" int __ttyname_r_chk(int, char*, size_t, size_t) noexcept;

using namespace puckloop::shim;

namespace puckloop::shim {

std::uint64_t up_nanoseconds() {
    return static_cast<std::uint64_t>(clock_nanoseconds(CLOCK_BOOTTIME));
}

unsigned processes_alive() {
    unsigned alive = 0;
    for (const wire::ProcessEntry& entry : page().processes)
        alive += entry.state == wire::ProcessEntry::Alive ? 1 : 0;
    return alive;
}

}  // namespace puckloop::shim

/// Deviation: the memory is that of the computer for which the programs of the robot are made, with half of
/// it free whatever they take; the load is 0.
SHIM_EXPORT int sysinfo(struct sysinfo* theirs) noexcept {
    if (!active()) return REAL(sysinfo)(theirs);
    charge(page().charges.clock);
    struct sysinfo info {};
    constexpr std::uint64_t kNanoseconds = 1'000'000'000;
    info.uptime = static_cast<long>(up_nanoseconds() / kNanoseconds);
    info.totalram = kBoardMemory;
    info.freeram = kBoardMemory / 2;
    info.procs = static_cast<unsigned short>(processes_alive());
    info.mem_unit = 1;
    return put_to_program(theirs, info) ? 0 : -1;
}

SHIM_EXPORT int getloadavg(double* loads, int count) noexcept {
    if (!active()) return REAL(getloadavg)(loads, count);
    constexpr int kMost = 3;
    std::fill_n(loads, std::clamp(count, 0, kMost), 0.0);
    return std::clamp(count, 0, kMost);
}

/// The board has one processor.
SHIM_EXPORT int sched_getcpu() noexcept {
    return active() ? 0 : REAL(sched_getcpu)();
}
SHIM_EXPORT int getcpu(unsigned* processor, unsigned* node) noexcept {
    if (!active()) return REAL(getcpu)(processor, node);
    const unsigned first = 0;
    const bool written = (processor == nullptr || put_to_program(processor, first)) &&
                         (node == nullptr || put_to_program(node, first));
    return written ? 0 : -1;
}

SHIM_EXPORT int ntp_gettimex(ntptimeval* theirs) noexcept {
    if (!active()) return REAL(ntp_gettimex)(theirs);
    timespec time{};
    clock_gettime(CLOCK_REALTIME, &time);
    constexpr long kNanosecondsPerMicrosecond = 1000;
    *theirs = {};
    theirs->time.tv_sec = time.tv_sec;
    theirs->time.tv_usec = time.tv_nsec / kNanosecondsPerMicrosecond;
    return TIME_ERROR;  // as of a clock that nothing disciplines
}

SHIM_EXPORT int __gethostname_chk(char* name, size_t size, size_t room) noexcept {
    if (size > room) __builtin_trap();
    return gethostname(name, size);
}
SHIM_EXPORT int __ttyname_r_chk(int fd, char* name, size_t size, size_t room) noexcept {
    if (size > room) __builtin_trap();
    return ttyname_r(fd, name, size);
}
