#include "tools/exec/options.h"

#include "base/error.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using exec::resolve_stop;

TEST_CASE("a stop address is a program address or a symbol") {
    image::Image image;
    image.file = "a.elf";
    image.symbols["_main"] = {0x1F48, image::Space::Program, true};
    image.symbols["counter"] = {0x800, image::Space::Data, true};
    CHECK(resolve_stop("0x1f48", image).pc == 0x1F48);
    CHECK(resolve_stop("0X1F48", image).pc == 0x1F48);
    CHECK(resolve_stop("main", image).pc == 0x1F48);
    CHECK(resolve_stop("main", image).name == "main");
    CHECK(resolve_stop("_main", image).pc == 0x1F48);
    for (const char* bad : {"0x", "0x1f49", "0x1000000", "0xzz", "0x10 ", "counter", "mian", ""})
        CHECK_THROWS_AS(resolve_stop(bad, image), InputError);
    image.symbols.clear();
    try {
        resolve_stop("main", image);
        FAIL("found");
    } catch (const InputError& error) {
        CHECK(std::string(error.what()) == "a.elf: --stop-at: the image has no symbols, so 'main' is unknown "
                                           "(expected 0xPC, or an ELF or COFF "
                                           "image)");
    }
}
