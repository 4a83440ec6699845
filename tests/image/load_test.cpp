#include "emu/image/device.h"
#include "emu/image/image.h"
#include "emu/image/intel_hex.h"
#include "tests/image/build_images.h"
#include "tests/image/expect_error.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace puckloop::image;
using namespace puckloop::image::testing;
using Catch::Matchers::Contains;

TEST_CASE("The same program is read from every format") {
    for (const std::string& bytes : {hex_image(), elf_image(), coff_image()}) {
        const Image image = parse_image(bytes, "x");
        INFO(name_of(image.format));
        CHECK(image.all_words() == sample_words());
        CHECK(image.program.size() == 6);
        CHECK(image.eeprom == Words{{0x7FF000, 0x1234}});
        CHECK(image.config == Words{{0xF80000, 0xC706}});
        CHECK(image.sha256.size() == 64);
        check_fits(image, kDspic30F6014A);
    }
}

TEST_CASE("Symbols of ELF and COFF know their space") {
    for (const std::string& bytes : {elf_image(), coff_image()}) {
        const Image image = parse_image(bytes, "x");
        INFO(name_of(image.format));
        CHECK(image.find_code("main") == 0x102u);
        CHECK(image.find_code("_main") == 0x102u);
        CHECK_FALSE(image.find_code("counter"));
        REQUIRE(image.symbols.count("_counter") == 1);
        CHECK(image.symbols.at("_counter").address == 0x800);
        CHECK(image.symbols.at("_counter").space == Space::Data);
        CHECK(image.symbols.count(".L1") == 0);
        CHECK(image.chip == "dspic30f6014a");
    }
}

TEST_CASE("An image for another chip is refused as such") {
    const Image elf = parse_image(elf_image(), "e.elf");
    CHECK(error_of([&] { check_fits(elf, kDspic33FJ256GP710); }) ==
          "e.elf: was built for another chip, dspic30f6014a (expected dspic33fj256gp710)");

    Words words = sample_words();
    words[0x000080] = 0x000290;  // a 33F interrupt vector; reserved on the 30F
    const Image vectors = parse_image(write_dspic_hex(words), "v.hex");
    CHECK_THAT(error_of([&] { check_fits(vectors, kDspic30F6014A); }),
               Contains("program address 0x000080: the dsPIC30F6014A has no memory there"));
    words[0x000080] = 0xFFFFFF;  // read back from a chip: erased
    check_fits(parse_image(write_dspic_hex(words), "v.hex"), kDspic30F6014A);

    const std::string avr = write_intel_hex({{0, {0x0C, 0x94, 0x34, 0x00, 0x0C, 0x94, 0x51, 0x12}}});
    CHECK_THAT(error_of([&] { parse_image(avr, "avr.hex"); }), Contains("phantom byte 0x12"));
    std::string avr_elf = elf_image();
    avr_elf[18] = 83;
    CHECK_THAT(error_of([&] { parse_image(avr_elf, "avr.elf"); }),
               Contains("another processor, e_machine 83 (AVR)"));
    CHECK_THAT(error_of([&] { find_device("pic16"); }), Contains("dspic30f6014a, dspic33fj256gp710"));
}

TEST_CASE("Files that cannot be an image are refused by name") {
    namespace fs = std::filesystem;
    const fs::path folder = puckloop::tests::scratch_path("puckloop_load_test");
    fs::create_directories(folder);
    const std::string missing = (folder / "missing.hex").string();
    CHECK(error_of([&] { load_image(missing); }) ==
          missing + ": no such file (expected a HEX, ELF or COFF image)");
    CHECK_THAT(error_of([&] { load_image(folder.string()); }), Contains("is a directory"));
    const std::string empty = (folder / "empty.cof").string();
    std::ofstream(empty).close();
    CHECK_THAT(error_of([&] { load_image(empty); }), Contains("empty.cof: is empty"));
    const std::string large = (folder / "large.hex").string();
    std::ofstream(large).close();
    fs::resize_file(large, 100u << 20);
    CHECK_THAT(error_of([&] { load_image(large); }), Contains("is 104857600 bytes large"));
    const std::string good = (folder / "good.hex").string();
    std::ofstream(good) << hex_image();
    CHECK(load_image(good).program.size() == 6);
    fs::remove_all(folder);

    CHECK_THAT(error_of([&] { parse_image("hello", "x"); }), Contains("in no known image format"));
    CHECK_THAT(error_of([&] { parse_image(":00000001FF\n", "x"); }), Contains("holds no program words"));
}

TEST_CASE("Broken tables are named with their offset") {
    const auto damage = [](std::string bytes, std::size_t at, unsigned char value) {
        bytes.at(at) = static_cast<char>(value);
        return error_of([&] { parse_image(bytes, "d"); });
    };
    const std::string elf = elf_image();
    CHECK_THAT(damage(elf, 4, 2), Contains("offset 0x4: is not a 32-bit ELF file"));
    CHECK_THAT(damage(elf, 5, 2), Contains("offset 0x5: is not little-endian"));
    CHECK_THAT(damage(elf, 16, 1), Contains("offset 0x10: is not a linked image"));
    CHECK_THAT(damage(elf, 35, 0x7F), Contains("the section table of 360 bytes runs past the end"));
    CHECK_THAT(damage(elf, 46, 41), Contains("offset 0x2E: the section table with entries of 41 bytes"));
    const std::string coff = coff_image();
    CHECK_THAT(damage(coff, 11, 0x7F), Contains("the symbol table of 54 bytes runs past the end"));
    CHECK_THAT(damage(coff, 18, 0), Contains("say an object file"));
    CHECK_THAT(damage(coff, 48 + 40 + 19, 0x7F),
               Contains("section .text of 2130706448 bytes runs past the end"));
    CHECK_THAT(damage(coff, 48 + 40 + 9, 0), Contains("was already given by"));
    for (const std::string& whole : {elf, coff, hex_image()})
        for (std::size_t length = 0; length + 3 < whole.size(); length += 7)
            CHECK(error_of([&] { parse_image(whole.substr(0, length), "cut"); }) != "");
}
