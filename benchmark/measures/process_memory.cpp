#include "benchmark/measures/process_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace puckloop::tools {

namespace {

/// 0 if there is no such process any more.
pid_t parent_of(const std::filesystem::path& folder) {
    std::ifstream file(folder / "stat");
    std::string text;
    std::getline(file, text);
    // The name, in parentheses, may hold anything.
    const auto end = text.rfind(')');
    if (end == std::string::npos) return 0;
    std::istringstream words(text.substr(end + 1));
    std::string state;
    pid_t parent = 0;
    words >> state >> parent;
    return parent;
}

double proportional_kbytes(pid_t process) {
    std::ifstream file(fmt::format("/proc/{}/smaps_rollup", process));
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string key;
        double kbytes = 0;
        if (words >> key >> kbytes && key == "Pss:") return kbytes;
    }
    return 0;
}

}  // namespace

std::vector<pid_t> process_tree(pid_t root) {
    std::multimap<pid_t, pid_t> children;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", error)) {
        const std::string name = entry.path().filename();
        pid_t process = 0;
        const auto [end, wrong] = std::from_chars(name.data(), name.data() + name.size(), process);
        if (wrong == std::errc() && end == name.data() + name.size())
            children.emplace(parent_of(entry.path()), process);
    }
    std::vector<pid_t> tree{root};
    for (std::size_t i = 0; i < tree.size(); ++i) {
        const auto [first, last] = children.equal_range(tree[i]);
        for (auto child = first; child != last; ++child)
            tree.push_back(child->second);
    }
    return tree;
}

double resident_mbytes(pid_t root) {
    constexpr double kKilobyte = 1024, kMegabytes = 1e-6;
    double sum = 0;
    for (const pid_t process : process_tree(root))
        sum += proportional_kbytes(process);
    return sum * kKilobyte * kMegabytes;
}

}  // namespace puckloop::tools
