#include "base/files/shipped_files.h"

#include <algorithm>
#include <cstdlib>
#include <string>
#include <system_error>
#include <vector>

namespace puckloop {

namespace fs = std::filesystem;

namespace {

/// The folder of the running program and those above it, the nearest first.
std::vector<fs::path> folders_above() {
    constexpr int kHighest = 6;  // from a test's folder to the sources around the build
    std::vector<fs::path> list;
    std::error_code error;
    fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (int i = 0; i < kHighest && folder.has_relative_path(); ++i, folder = folder.parent_path())
        list.push_back(folder);
    return list;
}

/// The folders in which shipped files may be, the nearest to the program first. A build outside of its
/// sources has a link to them as its share/puckloop.
std::vector<fs::path> roots() {
    std::vector<fs::path> list;
    if (const char* set = std::getenv("PUCKLOOP_DATA"); set != nullptr && *set != '\0')
        list.emplace_back(set);
    for (const fs::path& folder : folders_above()) {
        list.push_back(folder / "share" / "puckloop");
        list.push_back(folder);
    }
    return list;
}

}  // namespace

fs::path shipped_file(std::string_view name) {
    std::error_code error;
    for (const fs::path& root : roots())
        if (const fs::path file = root / name; fs::exists(file, error)) return file.lexically_normal();
    return {};
}

fs::path shipped_program(std::string_view file_name, std::string_view build_folder) {
    const std::vector<fs::path> folders = folders_above();
    if (folders.empty()) return {};
    std::error_code error;
    if (const fs::path beside = folders.front() / file_name; fs::is_regular_file(beside, error))
        return beside;
    for (const fs::path& folder : folders)
        for (const fs::path& place : {folder / "lib" / "puckloop", folder / build_folder})
            if (const fs::path file = place / file_name; fs::is_regular_file(file, error)) return file;
    return {};
}

fs::path main_program() {
    const fs::path path = shipped_program("puckloop", "tools");
    return path.empty() ? shipped_program("puckloop", "bin") : path;
}

fs::path shipped_image(std::string_view file_name) {
    if (file_name.empty() || file_name.find('/') != std::string_view::npos) return {};
    std::error_code error;
    for (const fs::path& root : roots()) {  // the build makes images beside the committed ones
        std::vector<fs::path> found;
        for (const fs::directory_entry& board : fs::directory_iterator(root / "firmware", error))
            if (const fs::path file = board.path() / file_name; fs::is_regular_file(file, error))
                found.push_back(file.lexically_normal());
        if (!found.empty()) return *std::min_element(found.begin(), found.end());
    }
    return {};
}

}  // namespace puckloop
