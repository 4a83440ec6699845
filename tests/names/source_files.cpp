#include "tests/names/source_files.h"

#include <algorithm>
#include <fstream>
#include <set>
#include <string_view>

namespace puckloop::names {

namespace fs = std::filesystem;

std::vector<SourceFile> source_files() {
    const std::set<std::string> kept{".h", ".cpp", ".c", ".py", ".md", ".toml", ".txt", ".cmake", ".inc"};
    const std::set<std::string> left_out{"build", "out", "experiments"};
    const fs::path root = PUCKLOOP_SOURCE;
    std::vector<SourceFile> files;
    for (fs::recursive_directory_iterator entry(root), end; entry != end; ++entry) {
        const std::string name = entry->path().filename().string();
        if (entry->is_directory()) {
            if (name.starts_with(".") || (entry.depth() == 0 && left_out.contains(name)))
                entry.disable_recursion_pending();
            continue;
        }
        if (!kept.contains(entry->path().extension().string())) continue;
        SourceFile file{fs::relative(entry->path(), root).generic_string(), {}};
        std::ifstream in(entry->path());
        for (std::string line; std::getline(in, line);)
            file.lines.push_back(line);
        files.push_back(std::move(file));
    }
    std::ranges::sort(files, {}, &SourceFile::path);
    return files;
}

std::vector<std::string> literals(const std::string& line) {
    const std::size_t first = line.find_first_not_of(' ');
    if (first == std::string::npos || line.compare(first, 2, "//") == 0 || line[first] == '#') return {};
    std::vector<std::string> found;
    bool inside = false;
    std::string text;
    for (std::size_t i = first; i < line.size(); ++i) {
        if (inside && line[i] == '\\' && i + 1 < line.size()) {
            text += line[++i];
        } else if (line[i] == '"' && !(i > 0 && !inside && line[i - 1] == '\'')) {
            if (inside) found.push_back(std::move(text));
            text.clear();
            inside = !inside;
        } else if (inside) {
            text += line[i];
        } else if (line.compare(i, 2, "//") == 0) {
            break;
        }
    }
    return found;
}

std::string comment(const std::string& line) {
    bool inside = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (inside && line[i] == '\\')
            ++i;
        else if (line[i] == '"' && !(i > 0 && !inside && line[i - 1] == '\''))
            inside = !inside;
        else if (!inside && line.compare(i, 2, "//") == 0)
            return line.substr(i + 2);
    }
    return {};
}

}  // namespace puckloop::names
