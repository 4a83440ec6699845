#pragma once
// The system calls behind those functions of the C library whose code this library replaces (libc_hooks.cpp).

namespace puckloop::shim {

/// What REAL(name) calls for a replaced function; nullptr for any other.
void* raw_function(const char* name);

}  // namespace puckloop::shim
