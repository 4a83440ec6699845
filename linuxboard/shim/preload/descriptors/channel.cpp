#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/stat.h>

namespace puckloop::shim {

bool is_channel(int fd) {
    struct stat status {};
    if (!active() || REAL(fstat)(fd, &status) != 0) return false;
    return S_ISFIFO(status.st_mode) || S_ISSOCK(status.st_mode);
}

}  // namespace puckloop::shim
