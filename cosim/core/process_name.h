#pragma once
// What ps and top show for the processes and threads of a run.

#include <string>
#include <string_view>

namespace puckloop::cosim {

/// What the command line of a node's process begins with.
inline constexpr std::string_view kNodeTitle = "puckloop: ";

/// Names the calling thread; of a process's first thread that is the name of the process too. The kernel
/// keeps 15 characters: of a longer name the last ones, in which nodes differ.
void name_thread(const std::string& name);

}  // namespace puckloop::cosim
