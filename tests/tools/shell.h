#pragma once
// Runs the built puckloop as a shell would.

#include "tests/kit/shell.h"

#include <string>

namespace puckloop::tests {

/// "puckloop ARGUMENTS" in a shell, with `input` (printf's escapes allowed) on standard input.
inline Ran run_puckloop(const std::string& arguments, const std::string& input = "") {
    return run_in_shell("printf '" + input + "' | " + PUCKLOOP_PROGRAM + " " + arguments);
}

}  // namespace puckloop::tests
