#pragma once
// What a limit of file sizes (ulimit -f) does to this process.

namespace puckloop::tools {

/// From now on a write past the limit fails with EFBIG, so that whoever writes says which file it was; the
/// signal that comes with it (SIGXFSZ, which ends a process) is caught. A process that ignores it already is
/// left so, and programs that this one executes have the usual signal.
void survive_file_size_limit();

}  // namespace puckloop::tools
