#pragma once
// Runs the built puckloop as a shell would.

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <array>
#include <cstdio>
#include <string>

namespace puckloop::tests {

struct Result {
    int status = 0;
    std::string output;  ///< standard output and error together
};

/// "puckloop ARGUMENTS" in a shell, with `input` (printf's escapes allowed) on standard input.
inline Result run_puckloop(const std::string& arguments, const std::string& input = "") {
    const std::string command =
        "printf '" + input + "' | " + std::string(PUCKLOOP_PROGRAM) + " " + arguments + " 2>&1";
    std::FILE* pipe = popen(command.c_str(), "r");
    REQUIRE(pipe != nullptr);
    Result result;
    std::array<char, 4096> buffer{};
    while (const std::size_t got = std::fread(buffer.data(), 1, buffer.size(), pipe))
        result.output.append(buffer.data(), got);
    result.status = WEXITSTATUS(pclose(pipe));
    return result;
}

}  // namespace puckloop::tests
