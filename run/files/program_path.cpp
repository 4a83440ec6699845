#include "run/files/program_path.h"

#include "base/files/shipped_files.h"

#include <cstdlib>
#include <sstream>
#include <unistd.h>

namespace puckloop::tools {

std::filesystem::path full_path(const std::filesystem::path& path) {
    const std::filesystem::path whole = std::filesystem::absolute(path);
    std::error_code error;
    const std::filesystem::path folder = std::filesystem::weakly_canonical(whole.parent_path(), error);
    return error ? whole.lexically_normal() : (folder / whole.filename()).lexically_normal();
}

std::filesystem::path own_image(const std::string& board) {
    return shipped_file("firmware/" + board + "/" + board + ".elf");
}

std::filesystem::path find_program(const std::string& name, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    if (name.find('/') != std::string::npos) return full_path(folder / name);
    if (const fs::path own = shipped_program(name, "linuxboard"); ::access(own.c_str(), X_OK) == 0)
        return own;
    const char* path = std::getenv("PATH");
    std::istringstream list(path ? path : "");
    for (std::string entry; std::getline(list, entry, ':');)
        if (!entry.empty() && ::access((fs::path(entry) / name).c_str(), X_OK) == 0)
            return fs::path(entry) / name;
    return name;
}

}  // namespace puckloop::tools
