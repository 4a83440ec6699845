#pragma once
// Signals as the kernel's calls have them: its sets have 8 bytes, with which the C library's begin.

#include <signal.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace puckloop::shim {

inline constexpr std::size_t kKernelSetSize = 8;

/// struct sigaction of rt_sigaction(); where there is no restorer the field is left out.
struct KernelAction {
    void* handler;
    unsigned long flags;
#if defined(__x86_64__)
    void* restorer;
#endif
    std::uint64_t mask;
};
#if defined(__x86_64__)
inline constexpr unsigned long kHasRestorer = 0x04000000;  // SA_RESTORER
#else
inline constexpr unsigned long kHasRestorer = 0;
#endif

inline sigset_t set_of_kernel(std::uint64_t mask) {
    sigset_t set;
    sigemptyset(&set);
    std::memcpy(&set, &mask, kKernelSetSize);
    return set;
}

inline std::uint64_t kernel_mask(const sigset_t& set) {
    std::uint64_t mask = 0;
    std::memcpy(&mask, &set, kKernelSetSize);
    return mask;
}

}  // namespace puckloop::shim
