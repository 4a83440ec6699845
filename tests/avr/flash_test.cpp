// Another image into an AVR that runs: what is erased, what stays.

#include "base/error.h"
#include "emu/avr/chip/chip_faults.h"
#include "emu/image/avr_image.h"
#include "tests/avr/rig.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop;
using namespace puckloop::avr;
using namespace puckloop::avr::test;

namespace {

constexpr std::uint32_t kBoot = 0x1E000;  ///< byte address of the boot section with BOOTSZ = 00

/// Counts `byte` up by `step` in RAM, for ever.
std::string counter(int step) {
    return "        .org 0\n        jmp main\n        .org 0x100\n"
           "main:   lds r16, 0x200\n"
           "        subi r16, " +
           std::to_string(256 - step) + "\n        sts 0x200, r16\n        rjmp main\n";
}

std::string file_of(const std::string& name, const std::string& source) {
    const Program program = assemble(source, {"test.s", &atmega1284p(), false});
    image::AvrImage image;
    for (const auto& [address, byte] : program.bytes)
        image.flash.push_back({address, {byte}});
    const auto file = tests::scratch_path(name);
    std::ofstream(file) << image::write_avr_hex(image);
    return file.string();
}

std::uint16_t word_at(Chip& chip, std::uint32_t address) {
    const image::AvrImage memory = chip.memory();
    const auto& bytes = memory.flash.at(0).bytes;
    return static_cast<std::uint16_t>(bytes.at(address) | bytes.at(address + 1) << 8);
}

void flash(Chip& chip, const std::string& file) {
    ChipFaults faults(chip);
    faults.read_image(file, "");
    faults.program(file);
    faults.reset(chip::FaultReset::External);
}

}  // namespace

TEST_CASE("the new program counts on in the RAM of the old one") {
    Rig rig(counter(1) + "        .org 0x4000\n        nop\n        nop\n");
    rig.run(16'000);
    const std::uint8_t before = rig.ram(0x200);
    CHECK(before > 100);
    rig.chip.eeprom().at(7) = 0x42;
    CHECK(word_at(rig.chip, 0x4000) == 0x0000);
    flash(rig.chip, file_of("avr_second.hex", counter(16)));
    CHECK(word_at(rig.chip, 0x4000) == 0xFFFF);  // erased
    CHECK(rig.chip.eeprom().at(7) == 0xFF);
    rig.run(16'300);
    const int counted = static_cast<std::uint8_t>(rig.ram(0x200) - before);
    CHECK(counted > 0);
    CHECK(counted % 16 == 0);
    CHECK(rig.chip.report().resets.back().cause == ResetCause::External);
}

TEST_CASE("fuses keep the EEPROM and the boot loader") {
    constexpr std::uint8_t kKeepsEeprom = 0xF7, kBootsInBoot = 0xF8;  // EESAVE; BOOTRST with BOOTSZ = 00
    const std::string boot = "        .org 0x1E000\nboot:   jmp 0\n";
    for (const bool keeps : {true, false}) {
        ChipOptions options;
        options.fuses.high =
            static_cast<std::uint8_t>(options.fuses.high & (keeps ? kKeepsEeprom & kBootsInBoot : 0xFF));
        Rig rig(counter(1) + boot, options);
        rig.run(1000);
        const std::uint16_t loader = word_at(rig.chip, kBoot);
        CHECK(loader != 0xFFFF);
        rig.chip.eeprom().at(7) = 0x42;
        flash(rig.chip, file_of("avr_third.hex", counter(16)));
        CHECK(word_at(rig.chip, kBoot) == (keeps ? loader : 0xFFFF));
        CHECK(rig.chip.eeprom().at(7) == (keeps ? 0x42 : 0xFF));
    }
}

TEST_CASE("what is no image of this AVR is refused") {
    Rig rig(counter(1));
    ChipFaults faults(rig.chip);
    CHECK_THROWS_AS(faults.read_image("/nowhere.hex", ""), InputError);
    const std::string file = file_of("avr_fourth.hex", counter(16));
    CHECK_THROWS_AS(faults.read_image(file, std::string(64, '0')), InputError);
    std::ofstream(file) << ":020000040010EA\n:0100000012ED\n:00000001FF\n";  // at 1 MB
    CHECK_THROWS_AS(faults.read_image(file, ""), InputError);
}
