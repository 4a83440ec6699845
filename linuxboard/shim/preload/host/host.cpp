#include "linuxboard/shim/preload/host/host.h"

#include "linuxboard/shim/preload/host/real.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

#include <cstring>

namespace puckloop::shim {

long host_call(long number, long a, long b, long c, long d, long e, long f) {
    return REAL(syscall)(number, a, b, c, d, e, f);
}

std::uintptr_t place_of_host_call() {
    return reinterpret_cast<std::uintptr_t>(REAL(syscall));
}

std::int64_t host_nanoseconds() {
    constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
    timespec time{};
    REAL(clock_gettime)(CLOCK_MONOTONIC, &time);
    return time.tv_sec * kNanosecondsPerSecond + time.tv_nsec;
}

void host_futex_wait(std::atomic<std::uint32_t>* word, std::uint32_t value) {
    host_call(SYS_futex, reinterpret_cast<long>(word), FUTEX_WAIT_PRIVATE, static_cast<long>(value));
}

void host_futex_wake(std::atomic<std::uint32_t>* word) {
    host_call(SYS_futex, reinterpret_cast<long>(word), FUTEX_WAKE_PRIVATE, 1);
}

void host_complain(const char* text) {
    host_call(SYS_write, STDERR_FILENO, reinterpret_cast<long>(text), static_cast<long>(std::strlen(text)));
}

}  // namespace puckloop::shim
