#pragma once
// The processor cores that a thread of this program uses.

#include <cstdint>

namespace puckloop::cosim {

/// Cores that this process may use; more than 0.
std::uint32_t usable_cores();

/// From now on the calling thread uses this core alone, if it may use it at all.
void use_one_core(std::uint32_t core);
/// The calling thread uses all cores again that it could use at first.
void use_all_cores();
/// In the child of a fork() or vfork(), before exec: the same for what it becomes. A system call, nothing
/// else: a conducted program must find the same cores whatever the run did with its own processes.
void use_all_cores_in_child();

/// Between two looks at what another core writes: leaves the core's other thread more of it.
inline void relax_core() {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
}

}  // namespace puckloop::cosim
