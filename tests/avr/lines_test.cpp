// Source lines of ELF files against binutils' avr-addr2line, for every address; damaged debug information.

#include "base/error.h"
#include "base/random.h"
#include "emu/avr/devices/device.h"
#include "emu/image/avr_image.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>

using namespace puckloop;

namespace {

std::uint32_t end_of_code(const image::AvrImage& image) {
    return image.symbols.contains("_etext") ? image.symbols.at("_etext").address : 0x1000;
}

void check(const std::string& elf) {
    const image::AvrImage image = image::load_avr_image(elf, avr::atmega1284p().image_part());
    REQUIRE_FALSE(image.lines.empty());
    const std::string asked = tests::scratch_path("addresses").string(), answers = asked + ".lines";
    {
        std::ofstream list(asked);
        for (std::uint32_t at = 0; at < end_of_code(image); at += 2)
            list << std::hex << at << '\n';
    }
    REQUIRE(std::system((std::string(ADDR2LINE) + " -e " + elf + " < " + asked + " > " + answers).c_str()) ==
            0);
    std::ifstream lines(answers);
    std::string line;
    int same = 0, known = 0;
    for (std::uint32_t at = 0; std::getline(lines, line); at += 2) {
        line = line.substr(0, line.find(" ("));
        line = line.substr(line.find_last_of('/') + 1);
        // With stabs addr2line gives the last line to all code behind it, the C library's too.
        if (line.starts_with("??") || line.ends_with(":?") || line.ends_with(":0") ||
            image.lines.at(at).empty())
            continue;
        ++known;
        same += image.lines.at(at) == line;
    }
    INFO(elf << ": " << same << " of " << known);
    CHECK(known > 500);
    CHECK(same >= known * 98 / 100);  // where two lines begin at one address either may be named
}

}  // namespace

TEST_CASE("an ELF of avr-gcc names the source line of each address, by stabs and by DWARF") {
    const std::string source = std::string(AVR_SOURCE) + "/compute.c";
    for (const char* format : {"-gstabs", "-gdwarf-2", "-gdwarf-4"}) {
        const std::string elf = tests::scratch_path("lines").string() + ".elf";
        REQUIRE(std::system((std::string(AVR_GCC) + " -mmcu=atmega1284p -std=gnu99 -O1 " + format + " " +
                             source + " -o " + elf + " -lm")
                                .c_str()) == 0);
        INFO(format);
        check(elf);
        const image::AvrImage image = image::load_avr_image(elf, avr::atmega1284p().image_part());
        const std::uint32_t main = *image.find_code("main");
        const std::string line = image.lines.at(main);
        REQUIRE(line.starts_with("compute.c:"));
        const auto found = image.lines.addresses("programs/compute.c",
                                                 static_cast<std::uint32_t>(std::stoi(line.substr(10))));
        CHECK(std::find(found.begin(), found.end(), main) != found.end());
        CHECK(image.lines.addresses("compute.c", 1).empty());

        // Whatever is in the debug sections, the program is read.
        const std::string bytes = tests::text_of(elf);
        RandomStream random(3, format);
        for (int i = 0; i < 200; ++i) {
            std::string damaged = bytes;
            const std::size_t debug = bytes.size() / 4;  // behind the code
            for (int n = 0; n < 20; ++n)
                damaged[debug + random.below(bytes.size() / 2)] = static_cast<char>(random.below(256));
            try {
                const auto again =
                    image::parse_avr_image(damaged, "damaged.elf", avr::atmega1284p().image_part());
                CHECK(again.flash.size() == image.flash.size());
            } catch (const InputError&) {  // symbols are checked
            }
        }
    }
}
