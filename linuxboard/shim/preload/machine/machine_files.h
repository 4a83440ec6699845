#pragma once

namespace puckloop::shim {

/// A file of /proc whose contents would be the host's, and other in each run: a descriptor of what it holds
/// on the board at this moment. -1 with errno unchanged: the path is none.
int open_machine_file(const char* path);

}  // namespace puckloop::shim
