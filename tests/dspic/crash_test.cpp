// Programs that go wrong: what the chip does, and that the report states it with place and symbol.

#include "base/json.h"
#include "emu/board/chip_json.h"
#include "emu/board/chip_warnings.h"
#include "emu/image/code_places.h"
#include "emu/image/image.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

struct Crash {
    Pins30 pins;
    Chip chip;
    std::map<std::string, std::uint32_t> symbols;

    explicit Crash(const std::string& source, const DeviceInfo& device = dspic30f6014a())
        : chip(device, pins, ChipOptions{.fosc = std::uint16_t{0xFFE6}}) {
        AssembleOptions options;
        for (const RegisterInfo& info : device.registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble(R"(
        goto main
        .org 0x08
        .pword address
        .pword stack
        .pword math
        .org 0x200
main:   mov #0x0900, w15
        mov #0x1000, w0
        mov w0, SPLIM
)" + source + R"(
        .org 0x400
address: bra address
stack:  bra stack
math:   bra math
)",
                                         options);
        image::Image image;
        image.chip = std::string(device.name);
        for (const auto& [address, word] : program.words)
            image.program[address] = word;
        for (const auto& [name, address] : program.symbols)
            if (address >= 0x200 && address < 0x1000)
                image.symbols[name] = {address, image::Space::Program, true};
        symbols = program.symbols;
        chip.load(image);
        chip.power_on();
        chip.run_until(6 * cosim::kMillisecond);  // all of the flash, as NOPs, takes 3 ms
    }
    std::string trap() const {
        const ChipReport report = chip.report();
        return report.traps.empty()
                   ? ""
                   : report.traps.front().name + " " + chip.places().symbol(report.traps.front().pc);
    }
    bool warned(const std::string& text) const {
        for (const std::string& line : board::chip_warnings(chip))
            if (line.find(text) != std::string::npos) return true;
        return false;
    }
};

}  // namespace

TEST_CASE("a jump into erased flash runs through to its end and into an address error") {
    const Crash crash(R"(
        mov #0x2000, w1
        goto w1
)");
    REQUIRE(crash.trap().starts_with("AddressError"));
    CHECK(crash.chip.report().traps.front().pc >= dspic30f6014a().flash_end);
    CHECK(crash.chip.pc() == crash.symbols.at("address"));
    CHECK(crash.warned("runs into erased flash (pc 0x2000"));
    CHECK(crash.warned("took the AddressError trap once"));
}

TEST_CASE("an illegal opcode resets with RCON<IOPUWR>, and the report has its place") {
    const Crash crash(R"(
        btsc RCON, #14
stay:   bra stay
wrong:  .pword 0x3f1234
)");
    const auto resets = crash.chip.report().resets;
    REQUIRE(resets.size() >= 2);
    CHECK(resets[1].cause == "IOPUWR");
    CHECK(crash.chip.places().symbol(resets[1].pc) == "wrong");
    CHECK((crash.chip.peek("RCON") & 0x4000) == 0x4000);
    CHECK(crash.warned("crashed into a reset (IOPUWR) once, first at pc 0x02"));
    CHECK(crash.warned(" in wrong"));
}

TEST_CASE("recursion without end is a stack error at SPLIM") {
    const Crash crash("deeper: rcall deeper\n");
    CHECK(crash.trap() == "StackError deeper");
    CHECK((crash.chip.peek("INTCON1") & 4) == 4);
    CHECK(crash.chip.pc() == crash.symbols.at("stack"));
    CHECK(board::chip_json(crash.chip)["traps"][0]["symbol"] == "deeper");
}

TEST_CASE("division by zero is a math error") {
    const Crash crash(R"(
        mov #7, w2
        clr w3
divide: repeat #17
        div.u w2, w3
after:  nop
)");
    CHECK(crash.trap().starts_with("MathError "));
    CHECK((crash.chip.peek("INTCON1") & 0x10) == 0x10);
    CHECK(crash.warned("took the MathError trap once, first at pc 0x02"));
}

TEST_CASE("flash is not written without the unlock sequence, and the report has it") {
    for (const bool unlocked : {false, true}) {
        CAPTURE(unlocked);
        const Crash crash(std::string(R"(
        mov #0x7f, w0
        mov w0, TBLPAG
        mov w0, NVMADRU
        mov #0xf000, w1
        mov w1, NVMADR
        mov #0x1234, w5
        tblwtl w5, [w1]
        mov #0x4004, w2
        mov w2, NVMCON
        mov #0x55, w4
        mov w4, NVMKEY
)") + (unlocked ? "        mov #0xaa, w4\n        mov w4, NVMKEY\n" : "") +
                          R"(
write:  bset NVMCON, #15
        nop
busy:   btsc NVMCON, #15
        bra busy
        bra busy
)");
        const auto memory = crash.chip.memory();
        CHECK(memory.contains(0x7FF000) == unlocked);
        CHECK(crash.warned("set NVMCON<WR> without the unlock sequence: nothing is written (pc 0x") ==
              !unlocked);
        if (!unlocked) CHECK(crash.warned(" in write"));
    }
}

TEST_CASE("a word access at an odd address is an address error with its place") {
    const Crash crash(R"(
        mov #0x0901, w1
odd:    mov [w1], w2
)");
    CHECK(crash.trap().starts_with("AddressError "));
    CHECK((crash.chip.peek("INTCON1") & 8) == 8);
}
