// Two types of one name in one namespace, each in its own header, are one type to the linker: it keeps one
// copy of what templates make of them (std::vector's growth), for the size of either. No compiler reports it.

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace fs = std::filesystem;

namespace {

// By the layout that .clang-format gives: namespaces and what is directly in them begin in the first column.
void collect(const fs::path& file, std::map<std::string, std::set<std::string>>& places) {
    static const std::regex opens("^namespace ([A-Za-z0-9_:]+) \\{$");
    static const std::regex defines(
        "^(?:struct|class|union|enum|enum class) ([A-Za-z0-9_]+)(?: final)?(?: :[^;]*)? \\{.*");
    std::ifstream stream(file);
    // Those that are open; "" for one without a name, where each file has its own.
    std::vector<std::string> scopes;
    std::smatch match;
    for (std::string line; std::getline(stream, line);) {
        if (line == "namespace {") {
            scopes.emplace_back();
        } else if (std::regex_match(line, match, opens)) {
            scopes.push_back(match[1]);
        } else if (line.starts_with("}  // namespace")) {
            if (!scopes.empty()) scopes.pop_back();
        } else if (!scopes.empty() && std::ranges::find(scopes, "") == scopes.end() &&
                   std::regex_match(line, match, defines)) {
            std::string name;
            for (const auto& scope : scopes)
                name += scope + "::";
            places[name + match[1].str()].insert(file.string());
        }
    }
}

}  // namespace

TEST_CASE("no two files define a type of the same name in the same namespace") {
    std::map<std::string, std::set<std::string>> places;
    for (const char* folder :
         {"base",          "bench", "benchmark",  "campaigns", "cosim",   "debug",     "emu",
          "ends",          "gap",   "linuxboard", "missions",  "physics", "protocols", "replay",
          "reproductions", "run",   "scenarios",  "selftest",  "tests",   "tools",     "traces"})
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(PUCKLOOP_SOURCE) / folder)) {
            const std::string extension = entry.path().extension().string();
            if (extension == ".cpp" || extension == ".h") collect(entry.path(), places);
        }
    CHECK(places.size() > 1000);
    for (const auto& [name, files] : places) {
        std::string list;
        for (const auto& file : files)
            list += "\n  " + file;
        INFO(name << " is defined in" << list);
        CHECK(files.size() == 1);
    }
}
