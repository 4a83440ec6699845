#pragma once
// A chip of either family with a program in assembly, and stretches of instructions that the program itself
// times by Timer1: what a logic analyser would see of a part, free of the emulator's own notion of a cycle.

#include "emu/chip/translate/translation_switch.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/devices/device.h"

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::dspic::test {

struct QuietPins : Pins {
    void driven(PortLetter, std::uint16_t, std::uint16_t, Cycle) override {}
    std::uint16_t levels(PortLetter, Cycle) override { return 0xFFFF; }
    double analog(int, Cycle) override { return 0.5; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { frames.emplace_back(unit, frame); }
    void i2c_phase(int, const cosim::I2cPhase&) override {}
    std::vector<std::pair<int, cosim::UartFrame>> frames;
};

struct TimedChip {
    QuietPins pins;
    Chip chip;
    Program program;

    /// `config` after the program: words by address, the rest erased.
    TimedChip(const DeviceInfo& device, const std::string& source,
              const std::vector<std::pair<std::uint32_t, std::uint32_t>>& config = {})
        : chip(device, pins, options(device)), program(assembled(device, source)) {
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        for (const auto& [address, word] : config)
            chip.load_word(address, word);
        chip.power_on();
    }
    static Program assembled(const DeviceInfo& device, const std::string& source) {
        AssembleOptions options;
        for (const RegisterInfo& info : device.registers)
            options.predefined[std::string(info.name)] = info.address;
        return assemble(source, options);
    }
    static ChipOptions options(const DeviceInfo& device) {
        return device.family_33f ? ChipOptions{4e6, 0.0} : ChipOptions{.fosc = std::uint16_t{0xFFE6}};
    }
    /// Runs to the label, which must be reached within `seconds`; returns the chip's cycle.
    Cycle run_to(const std::string& label, double seconds = 1.0) {
        if (chip.stopped_at()) chip.run_until(chip.now() + 1);
        chip.set_stops({program.symbol(label)});
        chip.run_until(chip.now() + cosim::from_seconds(seconds));
        chip.set_stops({});
        if (!chip.stopped_at()) throw std::runtime_error("label not reached: " + label);
        return chip.cycle();
    }
    int word(int address) const { return chip.peek_data(static_cast<std::uint16_t>(address)); }
};

/// What a stretch must take. In its text {0} is a label behind it and {1} a number of its own.
struct Stretch {
    std::string prepare, timed;
    int cycles = 0;
};

/// A program that times each stretch, over and over: hot code is translated where it can be.
class Stopwatch {
  public:
    Stopwatch(const DeviceInfo& device, const std::vector<Stretch>& stretches)
        : stretches_(stretches), chip_(device, source(device, stretches)) {}

    /// Cycles of each stretch in the first round, or after hundreds of them.
    std::vector<int> measure(bool hot) {
        if (hot) chip_.chip.run_until(chip_.chip.now() + 300 * cosim::kMillisecond);
        chip_.run_to("round");
        std::vector<int> cycles;
        for (std::size_t i = 0; i < stretches_.size(); ++i)
            cycles.push_back(chip_.word(kResults + 2 * static_cast<int>(i)));
        return cycles;
    }
    const TimedChip& chip() const { return chip_; }

  private:
    static constexpr int kResults = 0x0C00;

    static std::string source(const DeviceInfo& device, const std::vector<Stretch>& stretches) {
        std::string text = fmt::format(R"(
        goto    main
        .org    0x200
sub:    return
sub5:   retlw   #5, w2
main:   mov     #{:#x}, w15
        mov     #0x8000, w0
        mov     w0, T1CON
        setm    PR1
again:
)",
                                       device.ram_start + 0x200);
        for (std::size_t i = 0; i < stretches.size(); ++i) {
            const std::string label = fmt::format("n{}", i);
            text += fmt::format(
                R"(
        mov     #0x1234, w2
        mov     #0x0056, w3
        mov     #0x0100, w4
        mov     #0x0200, w5
        mov     #0x0300, w6
        mov     #0x0400, w7
        mov     #0x1404, w8         ; RAM of both families, X of the 30F
        mov     #0x1508, w9
        mov     #{:#x}, w10         ; Y data
        mov     #{:#x}, w11
        mov     #0x1600, w12
        mov     #0x1700, w14
        mov     #{:#x}, w15
        clr     SR
{}
        mov     TMR1, w0
        mov     w0, 0x1300          ; the stretch may write any register
{}
{}:     mov     TMR1, w1
        mov     0x1300, w0
        sub     w1, w0, w1
        dec2    w1, w1              ; reading and keeping it took a cycle each
        mov     w1, {:#x}
)",
                device.family_33f ? 0x4900 : 0x1A00, device.family_33f ? 0x4A00 : 0x1B00,
                device.ram_start + 0x200, fmt::format(fmt::runtime(stretches[i].prepare), label, i),
                fmt::format(fmt::runtime(stretches[i].timed), label, i), label, kResults + 2 * i);
        }
        return text + "round:  goto    again\n";
    }

    std::vector<Stretch> stretches_;
    TimedChip chip_;
};

}  // namespace puckloop::dspic::test
