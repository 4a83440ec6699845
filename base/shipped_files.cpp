#include "base/shipped_files.h"

#include <algorithm>
#include <string>
#include <system_error>
#include <vector>

namespace puckloop {

namespace fs = std::filesystem;

namespace {

/// The folders in which shipped files may be, the nearest to the program first.
std::vector<fs::path> roots() {
    constexpr int kHighest = 6;  // from a test's folder to the sources around the build
    std::vector<fs::path> list;
    std::error_code error;
    fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
    for (int i = 0; i < kHighest && folder.has_relative_path(); ++i, folder = folder.parent_path()) {
        list.push_back(folder / "share" / "puckloop");
        list.push_back(folder);
    }
    list.emplace_back(PUCKLOOP_SOURCE_FOLDER);  // a build outside of its sources
    return list;
}

}  // namespace

fs::path shipped_file(std::string_view name) {
    std::error_code error;
    for (const fs::path& root : roots())
        if (const fs::path file = root / name; fs::exists(file, error)) return file.lexically_normal();
    return {};
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
