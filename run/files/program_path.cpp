#include "run/files/program_path.h"

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
    namespace fs = std::filesystem;
    constexpr int kHighest = 4;  // from a test's folder to the build's
    std::error_code error;
    fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (int i = 0; i < kHighest && folder.has_relative_path(); ++i, folder = folder.parent_path()) {
        const fs::path image = folder / "firmware" / board / (board + ".elf");
        if (fs::exists(image, error)) return image;
    }
    return {};
}

std::filesystem::path find_program(const std::string& name, const std::filesystem::path& folder) {
    namespace fs = std::filesystem;
    if (name.find('/') != std::string::npos) return full_path(folder / name);
    std::error_code error;
    const fs::path self = fs::read_symlink("/proc/self/exe", error);
    // The project's own programs are built next to this one's folder, and installed beside it.
    for (const fs::path& beside : {self.parent_path(), self.parent_path().parent_path() / "linuxboard"})
        if (::access((beside / name).c_str(), X_OK) == 0) return beside / name;
    const char* path = std::getenv("PATH");
    std::istringstream list(path ? path : "");
    for (std::string entry; std::getline(list, entry, ':');)
        if (!entry.empty() && ::access((fs::path(entry) / name).c_str(), X_OK) == 0)
            return fs::path(entry) / name;
    return name;
}

}  // namespace puckloop::tools
