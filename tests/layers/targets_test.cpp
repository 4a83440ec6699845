// CMake's targets of gap agree with the order of its rooms: a room is in one target, which links all that
// holds what the room includes, and no target links back to itself.

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kGap = fs::path(PUCKLOOP_SOURCE) / "gap";

std::string all_of(const fs::path& file) {
    std::stringstream text;
    text << std::ifstream(file).rdbuf();
    return text.str();
}

struct Targets {
    std::map<std::string, std::set<std::string>> links;  // of each target
    std::map<std::string, std::set<std::string>> of;     // targets that a room's sources are in
};

void read_targets(const fs::path& folder, Targets& targets) {
    const std::string text = std::regex_replace(all_of(folder / "CMakeLists.txt"), std::regex("#[^\n]*"), "");
    const std::regex library("puckloop_library\\((\\w+)\\s+SOURCES([^)]*?)LINK([^)]*)\\)");
    const std::regex word("[\\w./:]+");
    for (auto it = std::sregex_iterator(text.begin(), text.end(), library); it != std::sregex_iterator();
         ++it) {
        const std::string name = (*it)[1], sources = (*it)[2], links = (*it)[3];
        for (auto w = std::sregex_iterator(sources.begin(), sources.end(), word); w != std::sregex_iterator();
             ++w) {
            const fs::path source = fs::relative(folder / w->str(), kGap);
            // Importers and generators write what they never read.
            if (source != "data/written.cpp") targets.of[source.begin()->string()].insert(name);
        }
        for (auto w = std::sregex_iterator(links.begin(), links.end(), word); w != std::sregex_iterator();
             ++w)
            targets.links[name].insert(w->str());
    }
}

/// All that a target links, and what these do.
std::set<std::string> below(const Targets& targets, const std::string& target) {
    std::set<std::string> all;
    std::vector<std::string> open{target};
    while (!open.empty()) {
        const std::string one = open.back();
        open.pop_back();
        if (const auto links = targets.links.find(one); links != targets.links.end())
            for (const std::string& next : links->second)
                if (all.insert(next).second) open.push_back(next);
    }
    return all;
}

}  // namespace

TEST_CASE("each room of gap is in one target, which links what the room includes") {
    Targets targets;
    read_targets(kGap, targets);
    for (const char* room : {"importers", "report", "stats"})
        read_targets(kGap / room, targets);
    REQUIRE(targets.of.size() > 20);
    for (const auto& [room, names] : targets.of) {
        INFO(room);
        CHECK(names.size() == 1);
    }
    for (const auto& [name, links] : targets.links) {
        INFO(name << " links itself in the end");
        CHECK_FALSE(below(targets, name).contains(name));
    }
    std::size_t includes = 0;
    for (const auto& entry : fs::recursive_directory_iterator(kGap)) {
        if (entry.path().extension() != ".cpp") continue;
        const std::string room = fs::relative(entry.path(), kGap).begin()->string();
        const auto own = targets.of.find(room);
        INFO(entry.path());
        REQUIRE(own != targets.of.end());
        const std::string target = *own->second.begin();
        const std::string text = all_of(entry.path());
        const std::regex include("#include \"gap/(\\w+)/(\\w+)\\.h\"");
        for (auto it = std::sregex_iterator(text.begin(), text.end(), include); it != std::sregex_iterator();
             ++it) {
            const std::string other = (*it)[1];
            if (other == room || (*it)[2] == "written" || !targets.of.contains(other)) continue;
            ++includes;
            const std::string needed = *targets.of.at(other).begin();
            INFO(target << " links no " << needed << ", of which it includes " << it->str());
            CHECK((needed == target || below(targets, target).contains(needed)));
        }
    }
    CHECK(includes > 200);
}
