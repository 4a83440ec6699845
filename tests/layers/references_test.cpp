// Files that comments and documents name are there: a path from the top of the project, with or without its
// ending, and in comments a bare name of a header or source.

#include "tests/layers/source_files.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace {

const std::vector<std::string> kTops = {
    "base", "bench",    "benchmark",  "campaigns", "cosim",   "debug",     "docs",    "emu",
    "ends", "gap",      "linuxboard", "missions",  "physics", "protocols", "replay",  "reproductions",
    "run",  "selftest", "tests",      "tools",     "traces",  "scenarios", "firmware"};

/// Named as examples of what a user writes, or made by the build.
const std::set<std::string> kExamples = {"docs/gap_predictive/NAME.svg", "docs/schema/NAME.json",
                                         "emu/dspic/peripherals/NAME.h", "firmware/tam/tam.elf",
                                         "tests/dspic/NAME_test.cpp",    "tests/NAME_board"};

struct Names {
    std::set<std::string> paths;                           ///< files with and without ending, and folders
    std::map<std::string, std::set<std::string>> folders;  ///< of a bare name
};

Names names() {
    Names all;
    for (const std::string& top : kTops)
        for (const std::string& file : layers::files_below(top)) {
            all.paths.insert(file);
            const std::string folder = layers::folder_of(file);
            const std::string name = file.substr(folder.size() + 1);
            all.folders[name].insert(folder);
            if (const std::size_t dot = name.find('.', 1); dot != std::string::npos)
                all.paths.insert(folder + "/" + name.substr(0, dot));
            for (std::string up = folder; !up.empty(); up = layers::folder_of(up))
                all.paths.insert(up);
        }
    return all;
}

/// "emu/dspic" of "emu/dspic/core": within it a bare name is understood.
std::string room_of(const std::string& folder) {
    const std::size_t first = folder.find('/');
    return first == std::string::npos ? folder : folder.substr(0, folder.find('/', first + 1));
}

const std::regex& path_pattern() {
    static const std::regex pattern = [] {
        std::string tops;
        for (const std::string& top : kTops)
            tops += (tops.empty() ? "" : "|") + top;
        return std::regex("(^|[^A-Za-z0-9_./<>$~-])((" + tops + ")(/[A-Za-z0-9_.<>-]+)+)");
    }();
    return pattern;
}

/// Those in `text` that are not there.
std::vector<std::string> missing_paths(const std::string& text, const Names& names) {
    std::vector<std::string> missing;
    for (auto match = std::sregex_iterator(text.begin(), text.end(), path_pattern());
         match != std::sregex_iterator(); ++match) {
        std::string path = (*match)[2];
        while (path.ends_with('.') || path.ends_with('-') || path.ends_with('/'))
            path.pop_back();
        const bool pattern = path.find('<') != std::string::npos;  // "frames_<name>.cpp"
        if (!pattern && !names.paths.contains(path) && !kExamples.contains(path)) missing.push_back(path);
    }
    return missing;
}

std::vector<std::string> missing_names(const std::string& file, const std::string& comment,
                                       const std::set<std::string>& included, const Names& names) {
    static const std::regex pattern("(^|[^A-Za-z0-9_./<-])([a-z0-9_]+\\.(h|cpp))\\b");
    std::vector<std::string> missing;
    const std::string room = room_of(layers::folder_of(file));
    for (auto match = std::sregex_iterator(comment.begin(), comment.end(), pattern);
         match != std::sregex_iterator(); ++match) {
        const std::string name = (*match)[2];
        if (included.contains(name)) continue;
        const auto found = names.folders.find(name);
        if (found == names.folders.end() ||
            std::none_of(found->second.begin(), found->second.end(), [&](const std::string& folder) {
                return folder == room || folder.starts_with(room + "/");
            }))
            missing.push_back(name);
    }
    return missing;
}

}  // namespace

TEST_CASE("a path or a name that is not there is found") {
    const Names all = names();
    CHECK(missing_paths("see base/error.h and base/error, base/fields.", all).empty());
    CHECK(missing_paths("see base/errors.h", all) == std::vector<std::string>{"base/errors.h"});
    CHECK(missing_paths("https://example.org/base/errors.h", all).empty());
    CHECK(missing_names("base/random.cpp", "// as error.h does", {}, all).empty());
    CHECK(missing_names("base/logs/log.cpp", "// as node.h does", {}, all) ==
          std::vector<std::string>{"node.h"});
    CHECK(missing_names("base/logs/log.cpp", "// as node.h does", {"node.h"}, all).empty());
}

TEST_CASE("files that comments name are there") {
    const Names all = names();
    int comments = 0;
    for (const std::string& top : kTops) {
        if (top == "firmware" || top == "tests" || top == "docs") continue;
        for (const std::string& file : layers::files_below(top)) {
            if (!layers::is_code(file)) continue;
            std::set<std::string> included;
            for (const std::string& path : layers::includes_of(file))
                included.insert(path.substr(path.rfind('/') + 1));
            for (const std::string& line : layers::lines_of(file)) {
                const std::size_t begin = line.find("//");
                if (begin == std::string::npos || line.find("http") != std::string::npos) continue;
                ++comments;
                const std::string comment = line.substr(begin);
                INFO(file << ": " << comment);
                CHECK(missing_paths(comment, all).empty());
                CHECK(missing_names(file, comment, included, all).empty());
            }
        }
    }
    CHECK(comments > 5000);
}

TEST_CASE("files that documents name are there") {
    const Names all = names();
    std::vector<std::string> pages{"README.md", "CONTRIBUTING.md"};
    for (const std::string& top : kTops)
        for (const std::string& file : layers::files_below(top))
            if (file.ends_with(".md")) pages.push_back(file);
    CHECK(pages.size() > 20);
    for (const std::string& page : pages)
        for (const std::string& line : layers::lines_of(page)) {
            INFO(page << ": " << line);
            CHECK(missing_paths(line, all).empty());
        }
}
