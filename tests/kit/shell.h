#pragma once
// A command as a user types it.

#include <string>

namespace puckloop::tests {

struct Ran {
    int status = -1;     ///< exit status; -1: a signal ended it
    std::string output;  ///< standard output and error together
};

/// Runs `command` in a shell until it ends.
Ran run_in_shell(const std::string& command);

}  // namespace puckloop::tests
