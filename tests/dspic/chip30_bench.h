#pragma once
// A dsPIC30F6014A at 14.7456 MIPS with a program in assembly. Its pins are recorded, and what comes from
// outside is set between instructions. Registers are named in the program as in the data sheet.

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"

#include "tests/dspic/peripherals/master_codec.h"

#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace puckloop::dspic::test {

struct Pins30 : Pins {
    struct Edge {
        Cycle at;
        bool level;

        friend bool operator==(const Edge&, const Edge&) = default;
    };
    struct Word {
        int unit;
        std::uint16_t sent;
        int bits;
        Cycle at;
    };
    std::array<std::uint16_t, 7> outside{};
    std::array<std::uint16_t, 7> levels_now{};
    std::array<std::uint16_t, 7> driven_now{};
    std::array<std::array<std::vector<Edge>, 16>, 7> edges;  ///< of pins while they are driven
    std::vector<cosim::UartFrame> frames;
    std::vector<cosim::I2cPhase> phases;
    std::vector<cosim::I2cPhase> answers;
    std::vector<Word> words;
    std::uint16_t spi_answer = 0xFFFF;
    bool pwm_edges = true;
    double volts = 0.5;  ///< at analog inputs, of the supply
    double vdd = 3.3;    ///< Chip::supply_changed() reports a new one
    MasterCodec codec;

    explicit Pins30(const DciMaster& codec_clocks = {}) : codec{codec_clocks} {}

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t driven, Cycle now) override {
        const auto p = static_cast<std::size_t>(port);
        for (std::size_t i = 0; i < 16; ++i) {
            const auto bit = static_cast<std::uint16_t>(1u << i);
            if ((levels ^ levels_now[p]) & driven & bit) edges[p][i].push_back({now, (levels & bit) != 0});
        }
        levels_now[p] = levels;
        driven_now[p] = driven;
    }
    std::uint16_t levels(PortLetter port, Cycle) override { return outside[static_cast<std::size_t>(port)]; }
    double analog(int, Cycle) override { return volts; }
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    void i2c_phase(int, const cosim::I2cPhase& phase) override { phases.push_back(phase); }
    void i2c_slave_answer(int, const cosim::I2cPhase& answer) override { answers.push_back(answer); }
    std::uint16_t spi_exchange(int unit, std::uint16_t sent, int bits, Cycle now) override {
        words.push_back({unit, sent, bits, now});
        return spi_answer;
    }
    std::uint16_t dci_exchange(const DciWord& word, Cycle now) override { return codec.exchange(word, now); }
    DciMaster dci_master() const override { return codec.clocks; }
    double supply() const override { return vdd; }
    bool wants_pwm_edges(int) const override { return pwm_edges; }
};

struct Bench30 {
    Pins30 pins;
    Chip chip;
    std::map<std::string, std::uint32_t> symbols;

    explicit Bench30(const std::string& source, std::map<std::uint32_t, std::uint32_t> config = {},
                     std::optional<std::uint16_t> fosc = 0xFFE6, Errata errata = {},
                     const DciMaster& codec = {})
        : pins(codec), chip(dspic30f6014a(), pins, ChipOptions{.fosc = fosc, .errata = errata}) {
        AssembleOptions options;
        for (const RegisterInfo& info : dspic30f6014a().registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble("        goto main\n" + source, options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        for (const auto& [address, word] : config)
            chip.load_word(address, word);
        symbols = program.symbols;
        chip.power_on();
    }
    /// Every event and instruction that starts before cycle `cycle` has been.
    void go(Cycle cycle) { chip.run_until(chip.clock().time_of(cycle)); }
    /// A pin's level from outside, from cycle `cycle` on.
    void set(PortLetter port, int bit, bool level, Cycle cycle) {
        go(cycle);
        std::uint16_t& levels = pins.outside[static_cast<std::size_t>(port)];
        const auto mask = static_cast<std::uint16_t>(1u << bit);
        levels = static_cast<std::uint16_t>(level ? levels | mask : levels & ~mask);
        chip.pins_changed(port);
    }
    /// A pulse: up at `cycle`, down after `width`.
    void pulse(PortLetter port, int bit, Cycle cycle, Cycle width) {
        set(port, bit, true, cycle);
        set(port, bit, false, cycle + width);
    }
    /// Runs to the label, which must be reached within 100 ms; returns the cycle.
    Cycle run_to(const std::string& label) {
        chip.set_stops({symbols.at(label)});
        chip.run_until(chip.now() + 100 * cosim::kMillisecond);
        chip.set_stops({});
        if (!chip.stopped_at()) throw std::runtime_error("label not reached: " + label);
        return chip.cycle();
    }
    const std::vector<Pins30::Edge>& edges(PortLetter port, int bit) const {
        return pins.edges[static_cast<std::size_t>(port)][static_cast<std::size_t>(bit)];
    }
    int word(int address) const { return chip.peek_data(static_cast<std::uint16_t>(address)); }
    int reg(std::string_view name) const { return chip.peek(name); }
};

}  // namespace puckloop::dspic::test
