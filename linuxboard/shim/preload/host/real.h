#pragma once
// The functions of the C library behind the ones this library takes over.

namespace puckloop::shim {

/// Address of the next definition of `name`; ends the program if there is none.
void* real_symbol(const char* name);

/// REAL(read)(fd, buffer, size) calls the C library's read().
#define REAL(name)                                                                                           \
    ([] {                                                                                                    \
        static const auto function =                                                                         \
            reinterpret_cast<decltype(&::name)>(::puckloop::shim::real_symbol(#name));                       \
        return function;                                                                                     \
    }())

}  // namespace puckloop::shim

/// A function that programs see.
#define SHIM_EXPORT extern "C" __attribute__((visibility("default")))
