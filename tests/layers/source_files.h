#pragma once
// The project's own sources, as tests of their order read them.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

namespace layers {

inline const std::filesystem::path& source() {
    static const std::filesystem::path folder = PUCKLOOP_SOURCE;
    return folder;
}

inline bool is_code(const std::filesystem::path& file) {
    return file.extension() == ".h" || file.extension() == ".cpp";
}

/// Relative paths of all files below `top`, sorted as the system gives them.
inline std::vector<std::string> files_below(std::string_view top) {
    std::vector<std::string> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source() / top))
        if (entry.is_regular_file())
            files.push_back(std::filesystem::relative(entry.path(), source()).generic_string());
    return files;
}

inline std::vector<std::string> lines_of(const std::string& file) {
    std::ifstream in(source() / file);
    std::vector<std::string> lines;
    for (std::string line; std::getline(in, line);)
        lines.push_back(line);
    return lines;
}

/// What the file includes of the project.
inline std::vector<std::string> includes_of(const std::string& file) {
    constexpr std::string_view kStart = "#include \"";
    std::vector<std::string> found;
    for (const std::string& line : lines_of(file))
        if (line.starts_with(kStart))
            found.push_back(line.substr(kStart.size(), line.find('"', kStart.size()) - kStart.size()));
    return found;
}

inline std::string folder_of(const std::string& file) {
    const std::size_t slash = file.rfind('/');
    return slash == std::string::npos ? std::string() : file.substr(0, slash);
}

}  // namespace layers
