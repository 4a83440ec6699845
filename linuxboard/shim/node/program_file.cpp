#include "linuxboard/shim/node/program_file.h"

#include "base/error.h"
#include "linuxboard/shim/wire/program_kind.h"

#include <elf.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

namespace puckloop::linuxboard {

namespace {
std::string search_path(const std::string& program) {
    if (program.find('/') != std::string::npos) return program;
    const char* path = std::getenv("PATH");
    std::istringstream folders(path != nullptr ? path : "/usr/bin:/bin");
    for (std::string folder; std::getline(folders, folder, ':');) {
        const std::string candidate = (folder.empty() ? "." : folder) + "/" + program;
        if (access(candidate.c_str(), X_OK) == 0) return candidate;
    }
    return program;
}

void check_file(const std::string& file, int depth) {
    struct stat status {};
    if (stat(file.c_str(), &status) != 0)
        throw InputError(file, "", std::strerror(errno), "a program for the Linux board");
    if (!S_ISREG(status.st_mode)) throw InputError(file, "", "is not a file", "a program");
    if (access(file.c_str(), X_OK) != 0) throw InputError(file, "", "is not executable", "chmod +x");
    const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0)
        throw InputError(file, "", std::string("cannot be opened: ") + std::strerror(errno),
                         errno == EMFILE ? "a higher limit of open files (ulimit -n)" : "a file to read");
    const wire::Obstacle obstacle = wire::obstacle_of_elf(descriptor, status);
    char head[256] = {};
    const bool has_head = pread(descriptor, head, sizeof head - 1, 0) > 2;
    close(descriptor);
    if (obstacle.why != nullptr)
        throw InputError(file, "", std::string("is ") + obstacle.why, obstacle.wanted);
    if (has_head && std::memcmp(head, ELFMAG, SELFMAG) == 0) return;
    if (!has_head || head[0] != '#' || head[1] != '!' || depth >= wire::kDeepestScript)
        throw InputError(file, "", "is neither a program nor a script",
                         "an ELF file or one that starts with #!");
    std::string interpreter;
    std::istringstream(head + 2) >> interpreter;
    check_file(interpreter, depth + 1);
}
}  // namespace

std::string find_program(const std::string& program) {
    std::string file = search_path(program);
    check_file(file, 0);
    return file;
}

}  // namespace puckloop::linuxboard
