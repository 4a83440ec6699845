#pragma once

#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

/// The first of a process that is conducted: it goes on as the program that it was made from left it.
void begin_process(Thread* main_thread);

}  // namespace puckloop::shim
