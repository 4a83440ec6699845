#pragma once
// System calls of the host, past everything this library takes over and past cancellation points.

#include <atomic>
#include <cstdint>

namespace puckloop::shim {

/// The C library's syscall(): -1 and errno on failure.
long host_call(long number, long a = 0, long b = 0, long c = 0, long d = 0, long e = 0, long f = 0);
/// A place in the C library's code that makes the system calls.
std::uintptr_t place_of_host_call();
/// CLOCK_MONOTONIC of the host.
std::int64_t host_nanoseconds();
void host_futex_wait(std::atomic<std::uint32_t>* word, std::uint32_t value);
void host_futex_wake(std::atomic<std::uint32_t>* word);
/// A line on the program's error output, for what the node cannot be sent.
void host_complain(const char* text);

}  // namespace puckloop::shim
