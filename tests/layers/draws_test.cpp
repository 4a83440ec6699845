// What a test draws follows Catch's seed, so that --rng-seed brings a failure back.

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace fs = std::filesystem;

TEST_CASE("no test draws from the system") {
    const fs::path tests = fs::path(PUCKLOOP_SOURCE) / "tests";
    const std::string source = std::string("random") + "_device";
    int files = 0;
    for (const auto& entry : fs::recursive_directory_iterator(tests)) {
        const std::string extension = entry.path().extension().string();
        if (extension != ".cpp" && extension != ".h") continue;
        // Programs that run under the emulated Linux board, which gives them its own.
        if (entry.path().string().find("/linuxboard/programs/") != std::string::npos) continue;
        std::ifstream stream(entry.path());
        const std::string text{std::istreambuf_iterator<char>(stream), {}};
        INFO(entry.path());
        CHECK(text.find(source) == std::string::npos);
        ++files;
    }
    CHECK(files > 100);
}
