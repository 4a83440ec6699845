// Source lines of dsPIC images, held to the sources they were built from.

#include "base/error.h"
#include "emu/image/image.h"
#include "emu/image/line_table.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <regex>
#include <sstream>

using namespace puckloop;

namespace {

struct Function {
    std::string file;
    int first = 0, end = 0;  ///< lines from its definition up to the next one
};

/// Functions, by name, of the C files of a folder.
std::map<std::string, Function> definitions(const std::string& folder) {
    static const std::regex kDefinition(R"(^[a-z].*?\b(\w+)\([^;]*\) \{)");
    std::map<std::string, Function> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        if (entry.path().extension() != ".c") continue;
        std::ifstream in(entry.path());
        std::string text;
        Function* last = nullptr;
        for (int line = 1; std::getline(in, text); ++line) {
            std::smatch match;
            if (!std::regex_search(text, match, kDefinition)) continue;
            if (last) last->end = line;
            last = &(found[match[1]] = {entry.path().filename().string(), line, 1 << 20});
        }
    }
    return found;
}

std::string bytes_of(const std::string& path) {
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("the project's dsPIC images name lines of each function at its beginning") {
    for (const auto& [board, image_name] : {std::pair{"epuck", "epuck_ircom.elf"}, {"rab", "rab.elf"}}) {
        const std::string folder = std::string(PUCKLOOP_FIRMWARE) + "/" + board;
        const image::Image image = image::load_image(folder + "/" + image_name);
        const image::LineTable lines = image::source_lines(folder + "/" + image_name);
        int compared = 0;
        for (const auto& [name, function] : definitions(folder)) {
            const auto symbol = image.symbols.find("_" + name);
            if (symbol == image.symbols.end() || !symbol->second.global)
                continue;  // names of static ones repeat
            INFO(board << ": " << name);
            const std::string place = lines.at(symbol->second.address);
            INFO(place);
            REQUIRE(place.starts_with(function.file + ":"));
            const int line = std::stoi(place.substr(function.file.size() + 1));
            CHECK(line >= function.first);
            CHECK(line < function.end);
            ++compared;
        }
        CHECK(compared > 30);
        CHECK(lines.at(image.find_code("__reset").value()).empty());  // assembly
    }
}

TEST_CASE("C30's COFF names functions' lines") {
    const char* images = std::getenv("PUCKLOOP_IMAGES");
    const std::string path = std::string(images ? images : "") + "/randb.cof";
    if (!images || !std::filesystem::exists(path)) {
        WARN("skipped: PUCKLOOP_IMAGES has no randb.cof");
        return;
    }
    const image::Image image = image::load_image(path);
    const image::LineTable lines = image::source_lines(path);
    // Each function's code begins in a C file and rises within it; what the library brought has no lines.
    const std::string slave = lines.at(image.find_code("init_I2C").value());
    CHECK(slave.find(".c:36") != std::string::npos);
    CHECK(lines.at(image.find_code("_SI2C1Interrupt").value()).ends_with(".c:85"));
    CHECK(lines.at(image.find_code("_SI2C1Interrupt").value() - 2).substr(0, slave.find(':')) ==
          slave.substr(0, slave.find(':')));
    CHECK(lines.stretches().size() > 800);
    CHECK(lines.at(0).empty());
}

TEST_CASE("damaged line tables are read as far as they go") {
    std::vector<std::string> paths{std::string(PUCKLOOP_FIRMWARE) + "/epuck/epuck.elf"};
    if (const char* images = std::getenv("PUCKLOOP_IMAGES"))
        if (std::filesystem::exists(std::string(images) + "/randb.cof"))
            paths.push_back(std::string(images) + "/randb.cof");
    std::mt19937 random(Catch::rngSeed());
    for (const std::string& path : paths) {
        const std::string whole = bytes_of(path);
        const std::string file = tests::scratch_path("damaged_lines").string();
        for (int i = 0; i < 10; ++i) {
            std::string damaged = whole;
            for (int k = 0; k < 200; ++k)
                damaged[random() % damaged.size()] = static_cast<char>(random());
            if (i % 2) damaged.resize(random() % damaged.size());
            std::ofstream(file, std::ios::binary) << damaged;
            try {
                (void)image::source_lines(file);
            } catch (const InputError&) {
            }
        }
        std::filesystem::remove(file);
    }
    SUCCEED("no crash, no endless loop");
}
