// Where the library begins to conduct a program.

#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/libc_hooks.h"
#include "linuxboard/shim/preload/processes/begin_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

/// Runs before the program's own initialisers, on its main thread.
__attribute__((constructor)) static void begin() {
    if (!connect_link()) return;
    hook_libc();
    guard_memory();
    begin_process(adopt_main_thread());
}

}  // namespace puckloop::shim
