#pragma once
// Memory that the program names in a call. Like the kernel, this library finds out that a pointer is bad when
// it follows it, and the call fails with EFAULT; a fault elsewhere is the program's own.

#include <cstddef>

namespace puckloop::shim {

/// `size` bytes from or to an address of the program; false (and errno EFAULT) if they are not all there.
bool copy_from_program(void* to, const void* from, std::size_t size);
bool copy_to_program(void* to, const void* from, std::size_t size);
template <typename T>
bool get_from_program(T& to, const void* from) {
    return copy_from_program(&to, from, sizeof to);
}
template <typename T>
bool put_to_program(void* to, const T& from) {
    return copy_to_program(to, &from, sizeof from);
}
/// How many of `size` bytes from `from` on can be read.
std::size_t readable_bytes(const void* from, std::size_t size);
/// A text that ends, shorter than PATH_MAX.
bool is_text(const char* text);

/// From now on faults come here first (fault_signals.cpp): in a process of which the node knows, once.
void guard_memory();

}  // namespace puckloop::shim
