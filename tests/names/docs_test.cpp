// Docs can be read in a terminal: lines of at most 100 columns. Links and pictures lead somewhere.

#include "tests/names/source_files.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <regex>

using namespace puckloop::names;

namespace {

constexpr std::size_t kColumns = 100;

/// Pages that tests write: their lines are as long as their rows.
bool is_generated(const std::string& path) {
    return path == "docs/registers.md"   // tests/dspic/register_coverage_test.cpp
           || path == "docs/images.md";  // tests/images/images_table_test.cpp
}

/// Pages of which a test reads a table row by row, so that a row stays a line.
bool has_read_rows(const std::string& path) {
    return path == "docs/timing_rules.md";  // tests/timing/rules_test.cpp
}

/// In code points: a multi-byte letter is one column.
std::size_t columns(const std::string& line) {
    std::size_t count = 0;
    for (const char c : line)
        count += (static_cast<unsigned char>(c) & 0xC0U) != 0x80U ? 1 : 0;
    return count;
}

/// The lines of a page that are prose, with their numbers: no code.
template <class F>
void each_line_of_prose(const SourceFile& page, F f) {
    bool fenced = false;
    for (std::size_t n = 0; n < page.lines.size(); ++n) {
        const std::string& line = page.lines[n];
        if (line.starts_with("```")) fenced = !fenced;
        if (!fenced && !line.starts_with("    ")) f(n + 1, line);
    }
}

}  // namespace

TEST_CASE("lines of docs end at column 100") {
    int pages = 0;
    for (const SourceFile& page : source_files()) {
        if (!page.ends_with(".md") || is_generated(page.path)) continue;
        ++pages;
        each_line_of_prose(page, [&](std::size_t n, const std::string& line) {
            const bool row = line.starts_with("|") && has_read_rows(page.path);
            const bool address = line.starts_with("![") || line.find("://") != std::string::npos;
            if (!row && !address && columns(line) > kColumns)
                FAIL_CHECK(page.path << ":" << n << ": " << columns(line) << " columns");
        });
    }
    CHECK(pages > 40);
}

TEST_CASE("links of docs lead to files that exist") {
    const std::filesystem::path root = PUCKLOOP_SOURCE;
    const std::regex link(R"(\]\(([^)\s#]+)(#[^)\s]*)?\))");
    int links = 0;
    for (const SourceFile& page : source_files()) {
        if (!page.ends_with(".md")) continue;
        each_line_of_prose(page, [&](std::size_t n, const std::string& line) {
            for (std::sregex_iterator found(line.begin(), line.end(), link), end; found != end; ++found) {
                const std::string target = (*found)[1];
                if (target.find("://") != std::string::npos) continue;
                ++links;
                if (!std::filesystem::exists((root / page.path).parent_path() / target))
                    FAIL_CHECK(page.path << ":" << n << ": " << target << " does not exist");
            }
        });
    }
    CHECK(links > 100);
}

TEST_CASE("every room of the project has a README that the map names") {
    const std::filesystem::path root = PUCKLOOP_SOURCE;
    std::string map;
    for (const SourceFile& page : source_files())
        if (page.path == "docs/architecture.md")
            for (const std::string& line : page.lines)
                map += line + "\n";
    CHECK(map.size() > 1000);
    for (const char* room :
         {"base",          "bench", "benchmark",  "campaigns", "cosim",   "debug",     "emu",
          "ends",          "gap",   "linuxboard", "missions",  "physics", "protocols", "replay",
          "reproductions", "run",   "scenarios",  "selftest",  "tools",   "traces",    "view"}) {
        INFO(room);
        CHECK(std::filesystem::exists(root / room / "README.md"));
        CHECK(map.find("(../" + std::string(room) + "/README.md)") != std::string::npos);
    }
}
