// No folders include each other in a circle: whoever reads one of them would have to read all.

#include "tests/layers/source_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace {

using Folders = std::set<std::string>;
using Includes = std::map<std::string, std::map<std::string, std::string>>;  // folder, folder, by which file

Includes includes() {
    Includes all;
    for (const char* top :
         {"base",          "bench", "benchmark",  "campaigns", "cosim",   "debug",     "emu",
          "ends",          "gap",   "linuxboard", "missions",  "physics", "protocols", "replay",
          "reproductions", "run",   "scenarios",  "selftest",  "tools",   "traces",    "view"})
        for (const std::string& file : layers::files_below(top)) {
            if (!layers::is_code(file)) continue;
            for (const std::string& included : layers::includes_of(file)) {
                const std::string from = layers::folder_of(file), to = layers::folder_of(included);
                if (from != to && std::filesystem::exists(layers::source() / included))
                    all[from].try_emplace(to, file + " includes " + included);
            }
        }
    return all;
}

/// Tarjan's strongly connected components, those of more than one folder.
std::vector<Folders> circles(const Includes& includes) {
    std::map<std::string, std::size_t> number, low;
    std::vector<std::string> open;
    std::vector<Folders> found;
    const std::function<void(const std::string&)> visit = [&](const std::string& folder) {
        number[folder] = low[folder] = number.size();
        open.push_back(folder);
        if (const auto next = includes.find(folder); next != includes.end())
            for (const auto& [other, why] : next->second) {
                if (!number.contains(other)) {
                    visit(other);
                    low[folder] = std::min(low[folder], low[other]);
                } else if (std::find(open.begin(), open.end(), other) != open.end()) {
                    low[folder] = std::min(low[folder], number[other]);
                }
            }
        if (low[folder] != number[folder]) return;
        Folders circle;
        while (true) {
            const std::string last = open.back();
            open.pop_back();
            circle.insert(last);
            if (last == folder) break;
        }
        if (circle.size() > 1) found.push_back(std::move(circle));
    };
    for (const auto& [folder, others] : includes)
        if (!number.contains(folder)) visit(folder);
    return found;
}

}  // namespace

TEST_CASE("a circle of folders is found, and a chain is none") {
    const Includes chain{{"a", {{"b", ""}}}, {"b", {{"c", ""}}}, {"d", {{"a", ""}}}};
    CHECK(circles(chain).empty());
    Includes ring = chain;
    ring["c"]["a"] = "";
    REQUIRE(circles(ring).size() == 1);
    CHECK(circles(ring)[0] == Folders{"a", "b", "c"});
}

TEST_CASE("folders include each other in no circle") {
    const Includes all = includes();
    CHECK(all.size() > 60);
    for (const Folders& circle : circles(all)) {
        std::string text;
        for (const std::string& folder : circle)
            for (const auto& [other, why] : all.at(folder))
                if (circle.contains(other)) text += "\n  " + why;
        FAIL_CHECK("a circle of " << circle.size() << " folders:" << text);
    }
}
