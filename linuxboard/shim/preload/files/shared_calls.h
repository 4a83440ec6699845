#pragma once

namespace puckloop::shim {

/// F_SETLKW and F_OFD_SETLKW.
int wait_for_lock(int fd, int command, void* lock);

}  // namespace puckloop::shim
