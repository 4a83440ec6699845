#pragma once
// Can this file run under the preloaded library? Reported before the run starts, not by a silent failure.

#include <string>

namespace puckloop::linuxboard {

/// `program` as execvp would find it. Throws InputError if it is not there, not executable, setuid or setgid,
/// statically linked, or made for another processor (scripts: the same of their interpreter).
std::string find_program(const std::string& program);

}  // namespace puckloop::linuxboard
