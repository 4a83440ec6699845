#include "bench/options.h"

#include "base/error.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using exec::resolve_stop;

namespace {
std::vector<std::uint32_t> no_lines(const std::string&, std::uint32_t) {
    return {};
}

// One line of two stretches of code, as a loop's condition has.
std::vector<std::uint32_t> two_addresses_of_line_12(const std::string& file, std::uint32_t line) {
    return file == "main.c" && line == 12 ? std::vector<std::uint32_t>{0x100, 0x120}
                                          : std::vector<std::uint32_t>{};
}
}  // namespace

TEST_CASE("a stop address is a program address or a symbol") {
    image::Image image;
    image.file = "a.elf";
    image.symbols["_main"] = {0x1F48, image::Space::Program, true};
    image.symbols["counter"] = {0x800, image::Space::Data, true};
    for (const char* good : {"0x1f48", "0X1F48", "main", "_main"}) {
        const auto stops = resolve_stop(good, image, no_lines);
        REQUIRE(stops.size() == 1);
        CHECK(stops[0].pc == 0x1F48);
        CHECK(stops[0].name == good);
    }
    for (const char* bad : {"0x", "0x1f49", "0x1000000", "0xzz", "0x10 ", "counter", "mian", ""})
        CHECK_THROWS_AS(resolve_stop(bad, image, no_lines), InputError);
    image.symbols.clear();
    try {
        resolve_stop("main", image, no_lines);
        FAIL("found");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()) == "a.elf: --stop-at: the image has no symbols, so 'main' is unknown "
                                           "(expected 0xPC, or an ELF or COFF "
                                           "image)");
    }
}

TEST_CASE("a stop address is every beginning of a source line") {
    image::Image image;
    image.file = "a.elf";
    const auto stops = resolve_stop("main.c:12", image, two_addresses_of_line_12);
    REQUIRE(stops.size() == 2);
    CHECK(stops[0].pc == 0x100);
    CHECK(stops[1].pc == 0x120);
    CHECK(stops[1].name == "main.c:12");
    for (const char* bad : {"main.c:13", "other.c:12", "main.c:", "main.c:0x12", "main.c:12a", ":12"})
        CHECK_THROWS_AS(resolve_stop(bad, image, two_addresses_of_line_12), InputError);
}
