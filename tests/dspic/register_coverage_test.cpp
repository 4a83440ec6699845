// docs/registers.md lists what becomes of every register of the device tables. The file is made by this test
// (PUCKLOOP_WRITE_REGISTERS=1) and held to it.

#include "emu/dspic/chip/chip.h"
#include "emu/dspic/machine/sfr_space.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/waits/status_bits.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <sstream>

using namespace puckloop::dspic;

namespace {

struct NoPins : Pins {
    void driven(PortLetter, std::uint16_t, std::uint16_t, Cycle) override {}
    std::uint16_t levels(PortLetter, Cycle) override { return 0; }
    double analog(int, Cycle) override { return 0; }
    void uart_sent(int, const puckloop::cosim::UartFrame&) override {}
    void i2c_phase(int, const puckloop::cosim::I2cPhase&) override {}
};

struct List {
    std::string text;
    int count = 0;
    std::size_t line = 0;

    void add(const std::string& name) {
        constexpr std::size_t kWidth = 108;
        ++count;
        if (line + name.size() + 1 > kWidth) {
            text += "\n";
            line = 0;
        } else if (!text.empty()) {
            text += " ";
            ++line;
        }
        text += name;
        line += name.size();
    }
    std::string section(const std::string& title) const {
        return "### " + title + " (" + std::to_string(count) + ")\n\n" + (text.empty() ? "none" : text) +
               "\n\n";
    }
};

std::string coverage(const DeviceInfo& device, int& registers, int& modelled) {
    NoPins pins;
    Chip chip(device, pins, {});
    const SfrSpace& sfr = chip.inside().sfr;
    List acting, stored, absent, bits;
    for (const RegisterInfo& info : device.registers) {
        const std::string name(info.name);
        if (sfr.acts(info.address))
            acting.add(name);
        else if (sfr.modelled(info.address))
            stored.add(name);
        else
            absent.add(name);
        if (const std::uint16_t missing = missing_bits(device, info); missing && sfr.modelled(info.address))
            bits.add("[" + register_text(info, missing) + "]");
    }
    registers = acting.count + stored.count + absent.count;
    modelled = acting.count + stored.count;
    return "## " + std::string(device.name) + "\n\n" +
           "| registers | a model acts | kept for a model | no model |\n|---|---|---|---|\n| " +
           std::to_string(registers) + " | " + std::to_string(acting.count) + " | " +
           std::to_string(stored.count) + " | " + std::to_string(absent.count) + " |\n\n" +
           absent.section("No model: the first touch is reported") +
           bits.section("Bits that silicon sets and no model does, in registers that have one") +
           stored.section("Kept: a model may read them, none acts when they are written") +
           acting.section("A model acts on accesses or changes them");
}

}  // namespace

TEST_CASE("docs/registers.md lists what becomes of every register") {
    std::string text = "# Registers of the dsPICs and what stands behind them\n\n"
                       "Made from the device tables (`emu/dspic/devices`) and the models' own claims; a test "
                       "holds it to them.\n"
                       "What a model leaves out of a register that it acts on stands in "
                       "[fidelity.md](fidelity.md) and at the top\n"
                       "of the model's header.\n\n";
    for (const DeviceInfo* device : devices()) {
        int registers = 0, modelled = 0;
        text += coverage(*device, registers, modelled);
        CHECK(registers == static_cast<int>(device->registers.size()));
    }
    text.pop_back();
    const std::string path = std::string(PUCKLOOP_SOURCE) + "/docs/registers.md";
    if (std::getenv("PUCKLOOP_WRITE_REGISTERS")) std::ofstream(path) << text;
    std::ifstream file(path);
    std::stringstream found;
    found << file.rdbuf();
    INFO("PUCKLOOP_WRITE_REGISTERS=1 makes the file anew");
    const bool same = found.str() == text;
    CHECK(same);
}
