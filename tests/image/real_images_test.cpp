// Images made by Microchip's tools, from the folder that PUCKLOOP_IMAGES names. The two forms of one program
// must agree word for word.

#include "emu/image/device.h"
#include "emu/image/image.h"
#include "tests/image/expect_error.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>
#include <optional>

using namespace puckloop::image;
using puckloop::image::testing::error_of;

namespace {

std::optional<Image> real(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    const std::string path = folder ? std::string(folder) + "/" + name : "";
    if (!folder || !std::filesystem::exists(path)) {
        WARN("skipped: set PUCKLOOP_IMAGES to a folder that holds " << name);
        return std::nullopt;
    }
    return load_image(path);
}

}  // namespace

TEST_CASE("XC16's ELF and HEX of demoGCtronic agree word for word") {
    const auto elf = real("demoGCtronic.X.production.elf");
    const auto hex = real("demoGCtronic.X.production.hex");
    if (!elf || !hex) return;
    CHECK(elf->all_words() == hex->all_words());
    CHECK(elf->program.size() > 40000);
    CHECK(elf->chip == "dspic30f6014a");
    CHECK(elf->find_code("main").has_value());
    check_fits(*elf, kDspic30F6014A);
    check_fits(*hex, kDspic30F6014A);
    CHECK(error_of([&] { check_fits(*hex, kDspic33FJ256GP710); }) != "");
}

TEST_CASE("C30's COFF and HEX of randb agree word for word") {
    const auto coff = real("randb.cof");
    const auto hex = real("randb.hex");
    if (!coff || !hex) return;
    CHECK(coff->all_words() == hex->all_words());
    CHECK(coff->program.size() == 7198);
    CHECK(coff->chip == "dspic33fj256gp710");
    CHECK(coff->find_code("main") == 0x3638u);
    check_fits(*coff, kDspic33FJ256GP710);
    check_fits(*hex, kDspic33FJ256GP710);
    CHECK(error_of([&] { check_fits(*hex, kDspic30F6014A); }) != "");
}

TEST_CASE("Every e-puck image fits the e-puck's chip, the range-and-bearing image does not") {
    for (const char* name : {"BTcom_default.hex", "BTcom_20_LIS_rev84.hex", "Demo.hex", "epuck_firmware.hex",
                             "epuck_firmware_old.hex", "demoGCtronic-rev117+bootloader+EEPROM-FFF7.hex",
                             "tinybld_ds6014A_7.37Mhz_115200uart1_8xPLL_with_LEDs.hex"})
        if (const auto image = real(name)) check_fits(*image, kDspic30F6014A);
    if (const auto rab = real("erab_1to4b.hex")) {
        check_fits(*rab, kDspic33FJ256GP710);
        CHECK(error_of([&] { check_fits(*rab, kDspic30F6014A); }) != "");
    }
}
