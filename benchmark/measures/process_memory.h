#pragma once
// Memory of a process with all that it started, from /proc.

#include <sys/types.h>

#include <vector>

namespace puckloop::tools {

/// `root` and its descendants that are alive now.
std::vector<pid_t> process_tree(pid_t root);

/// Their resident memory, 1e6 bytes; a page that several share counts once, divided among them ("Pss"). One
/// that ends meanwhile counts nothing.
double resident_mbytes(pid_t root);

}  // namespace puckloop::tools
