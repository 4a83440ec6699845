#include "linuxboard/shim/node/program_file.h"

#include "base/error.h"

#include <elf.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

namespace puckloop::linuxboard {

namespace {
#if defined(__x86_64__)
constexpr int kHostMachine = EM_X86_64;
#elif defined(__aarch64__)
constexpr int kHostMachine = EM_AARCH64;
#else
#error "unknown host processor"
#endif
constexpr int kDeepestScript = 4;

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

void check_elf(const std::string& file, std::ifstream& in) {
    Elf64_Ehdr header{};
    in.seekg(0);
    in.read(reinterpret_cast<char*>(&header), sizeof header);
    if (!in || header.e_ident[EI_CLASS] != ELFCLASS64 || header.e_machine != kHostMachine)
        throw InputError(file, "", "is a program for another processor", "one built for this machine");
    std::vector<Elf64_Phdr> segments(header.e_phnum);
    in.seekg(static_cast<std::streamoff>(header.e_phoff));
    in.read(reinterpret_cast<char*>(segments.data()),
            static_cast<std::streamsize>(segments.size() * sizeof(Elf64_Phdr)));
    bool is_dynamic = false;
    for (const Elf64_Phdr& segment : segments)
        is_dynamic = is_dynamic || segment.p_type == PT_INTERP;
    if (!in || !is_dynamic) {
        throw InputError(file, "", "is statically linked, so its system calls cannot be taken over",
                         "a dynamically linked program");
    }
}

void check_file(const std::string& file, int depth) {
    struct stat status {};
    if (stat(file.c_str(), &status) != 0)
        throw InputError(file, "", std::strerror(errno), "a program for the Linux board");
    if (!S_ISREG(status.st_mode)) throw InputError(file, "", "is not a file", "a program");
    if (access(file.c_str(), X_OK) != 0) throw InputError(file, "", "is not executable", "chmod +x");
    if ((status.st_mode & (S_ISUID | S_ISGID)) != 0 && geteuid() != status.st_uid)
        throw InputError(file, "", "is setuid or setgid, so nothing can be preloaded into it");
    std::ifstream in(file, std::ios::binary);
    if (!in)
        throw InputError(file, "", std::string("cannot be opened: ") + std::strerror(errno),
                         errno == EMFILE ? "a higher limit of open files (ulimit -n)" : "a file to read");
    char magic[4] = {};
    in.read(magic, sizeof magic);
    if (std::memcmp(magic, ELFMAG, SELFMAG) == 0) {
        check_elf(file, in);
    } else if (magic[0] == '#' && magic[1] == '!' && depth < kDeepestScript) {
        in.clear();
        in.seekg(2);
        std::string interpreter;
        in >> interpreter;
        check_file(interpreter, depth + 1);
    } else {
        throw InputError(file, "", "is neither a program nor a script",
                         "an ELF file or one that starts with #!");
    }
}
}  // namespace

std::string find_program(const std::string& program) {
    std::string file = search_path(program);
    check_file(file, 0);
    return file;
}

}  // namespace puckloop::linuxboard
