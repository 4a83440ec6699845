#pragma once
// `--linux PROGRAM [ARG]...` takes arguments that look like options; they are packed away before CLI11 sees
// them.

#include <string>
#include <vector>

namespace puckloop::tools {

/// Rewrites the words after `--linux` as --linux=PROGRAM --linux-arg=ARG ... The list ends at the next option
/// of `run` itself; after a `--` everything belongs to the program. Other words stay as they are.
std::vector<std::string> pack_linux_arguments(const std::vector<std::string>& words);

}  // namespace puckloop::tools
