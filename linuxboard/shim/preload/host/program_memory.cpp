#include "linuxboard/shim/preload/host/program_memory.h"

#include "linuxboard/shim/preload/host/fault_signals.h"

#include <limits.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace puckloop::shim {

namespace {
constexpr std::uintptr_t kPage = 4096;

/// Does `work`, which may follow bad pointers but changes nothing of this library; false if it met one.
template <typename Work>
__attribute__((noinline)) bool guarded(Work work) {
    sigjmp_buf here;
    if (sigsetjmp(here, 0) != 0) {  // the handler has taken the guard away
        errno = EFAULT;
        return false;
    }
    sigjmp_buf* const before = set_fault_guard(&here);
    asm volatile("" ::: "memory");
    work();
    asm volatile("" ::: "memory");
    set_fault_guard(before);
    return true;
}

/// Whether addresses are ones that a program can have: beyond them the processor reports no address.
bool is_in_range(const void* from, std::size_t size) {
    constexpr std::uintptr_t kEnd = std::uintptr_t{1} << 47;
    const auto begin = reinterpret_cast<std::uintptr_t>(from);
    return begin < kEnd && size <= kEnd - begin;
}
}  // namespace

bool copy_from_program(void* to, const void* from, std::size_t size) {
    if (size == 0) return true;
    if (is_in_range(from, size) && guarded([&] { std::memcpy(to, from, size); })) return true;
    errno = EFAULT;
    return false;
}

bool copy_to_program(void* to, const void* from, std::size_t size) {
    if (size == 0) return true;
    if (is_in_range(to, size) && guarded([&] { std::memcpy(to, from, size); })) return true;
    errno = EFAULT;
    return false;
}

std::size_t readable_bytes(const void* from, std::size_t size) {
    const int error = errno;
    const auto begin = reinterpret_cast<std::uintptr_t>(from);
    std::uintptr_t at = begin;
    const std::uintptr_t end = begin + size;
    while (at < end && is_in_range(reinterpret_cast<const void*>(at), 1)) {
        const auto* byte = reinterpret_cast<const volatile char*>(at);
        if (!guarded([byte] { static_cast<void>(*byte); })) break;
        at = std::min(end, (at / kPage + 1) * kPage);
    }
    errno = error;
    return at - begin;
}

bool is_text(const char* text) {
    if (!is_in_range(text, 1)) return false;
    const int error = errno;
    bool ends = false;
    const bool there = guarded([&] { ends = strnlen(text, PATH_MAX) < PATH_MAX; });
    errno = error;
    return there && ends;
}

}  // namespace puckloop::shim
