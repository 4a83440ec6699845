#pragma once
// How a call that is taken over says that it failed.

#include <cerrno>

namespace puckloop::shim {

/// What the call returns: -1, with the reason in errno.
inline int fail(int error) {
    errno = error;
    return -1;
}

}  // namespace puckloop::shim
