// docs/timing_rules.md names tests that exist.

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace {
std::string content(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}
}  // namespace

TEST_CASE("each rule of docs/timing_rules.md has its source and a test that exists") {
    const std::filesystem::path root = PUCKLOOP_SOURCE;
    const std::string document = content(root / "docs/timing_rules.md");
    const std::regex row(
        R"(\n\| ([A-Z]\d+) \| ([^|\n]+) \| ([^|\n]+) \| `([a-z_0-9/]+\.cpp)`: ([^|\n]+) \|)");
    std::set<std::string> seen;
    for (std::sregex_iterator found(document.begin(), document.end(), row), end; found != end; ++found) {
        const std::smatch& match = *found;
        INFO(match[0]);
        CHECK(seen.insert(match[1]).second);
        CHECK_FALSE(match[3].str().empty());
        // The compiler joins literals that the formatter has cut.
        const std::string source =
            std::regex_replace(content(root / "tests" / match[4].str()), std::regex("\"\\s*\""), "");
        CHECK(source.find("\"" + match[5].str() + "\"") != std::string::npos);
    }
    CHECK(seen.size() >= 40);
    // No row that the pattern has missed.
    const std::regex any(R"(\n\| [A-Z]\d+ \|)");
    CHECK(std::distance(std::sregex_iterator(document.begin(), document.end(), any),
                        std::sregex_iterator()) == static_cast<std::ptrdiff_t>(seen.size()));
}
