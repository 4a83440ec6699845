#include "tests/kit/shell.h"

#include <array>
#include <cstdio>
#include <stdexcept>

#include <sys/wait.h>

namespace puckloop::tests {

Ran run_in_shell(const std::string& command) {
    std::FILE* pipe = ::popen(("(" + command + ") 2>&1").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("no shell for " + command);
    Ran ran;
    std::array<char, 4096> piece{};
    while (const std::size_t got = std::fread(piece.data(), 1, piece.size(), pipe))
        ran.output.append(piece.data(), got);
    const int status = ::pclose(pipe);
    if (WIFEXITED(status)) ran.status = WEXITSTATUS(status);
    return ran;
}

}  // namespace puckloop::tests
