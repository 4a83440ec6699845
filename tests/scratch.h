#pragma once
// A place for a test's files that no other test, running at the same time, has.

#include <filesystem>
#include <string>
#include <unistd.h>

namespace puckloop::tests {

/// Not made yet; CTest runs every case in a process of its own, so the process number tells cases apart.
inline std::filesystem::path scratch_path(const std::string& name) {
    return std::filesystem::temp_directory_path() / (name + "." + std::to_string(::getpid()));
}

}  // namespace puckloop::tests
