#pragma once

namespace puckloop::shim {

/// Lets the C library's own calls of read(), write(), open() and the like come to this library, so that its
/// streams reach devices and pipes on any descriptor. Ends the process with one line if that cannot be done.
/// Once, before the program has threads.
void hook_libc();

}  // namespace puckloop::shim
