#pragma once
// What the tables of system calls share (syscalls.h).

#include "linuxboard/shim/preload/host/failure.h"

#include <type_traits>

namespace puckloop::shim {

/// An argument of a system call, as the function that takes it over wants it.
struct Argument {
    long value = 0;
    template <typename T>
    operator T*() const {
        return reinterpret_cast<T*>(value);
    }
    template <typename T, typename = std::enable_if_t<std::is_integral_v<T> || std::is_enum_v<T>>>
    operator T() const {
        return static_cast<T>(value);
    }
};

/// The result of a call whose function returns its error: 0, or -1 and errno.
inline long failed(int error) {
    return error == 0 ? 0 : fail(error);
}

}  // namespace puckloop::shim

/// A row of a table: the system call is this call of a function that is taken over.
#define PUCKLOOP_SYSCALL(name, call)                                                                         \
    case SYS_##name:                                                                                         \
        *result = (call);                                                                                    \
        return true
