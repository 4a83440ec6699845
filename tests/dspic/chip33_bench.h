#pragma once
// A dsPIC33FJ256GP710 with a program in assembly and a bench around its pins. The configuration words are the
// range-and-bearing board's: RC oscillator at first, XT crystal, clock switching on.

#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"

#include <array>
#include <map>
#include <string>
#include <vector>

namespace puckloop::dspic::test {

struct Pins33 : Pins {
    struct Edge {
        Cycle at;
        std::uint16_t levels;
    };
    std::vector<Edge> edges;  ///< of port B
    std::vector<Edge> port_d;
    std::uint16_t driven_d = 0;
    std::vector<int> asked;  ///< analog inputs
    std::array<double, 32> volts{};
    std::vector<cosim::UartFrame> frames;
    std::vector<cosim::I2cPhase> answers;
    std::vector<int> spi_sent;
    std::uint16_t spi_answer = 0;
    std::vector<int> compare_changes;

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t driven, Cycle now) override {
        if (port == PortLetter::B) edges.push_back({now, levels});
        if (port == PortLetter::D) {
            port_d.push_back({now, levels});
            driven_d = driven;
        }
    }
    std::uint16_t levels(PortLetter, Cycle) override { return 0xFFFF; }
    double analog(int channel, Cycle) override {
        asked.push_back(channel);
        return volts[static_cast<std::size_t>(channel)];
    }
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    void i2c_phase(int, const cosim::I2cPhase&) override {}
    void i2c_slave_answer(int, const cosim::I2cPhase& answer) override { answers.push_back(answer); }
    std::uint16_t spi_exchange(int, std::uint16_t sent, int, Cycle) override {
        spi_sent.push_back(sent);
        return spi_answer;
    }
    void output_compare_changed(int unit, Cycle) override { compare_changes.push_back(unit); }
};

inline double in_microseconds(cosim::Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kMicrosecond);
}

struct Bench33 {
    Pins33 pins;
    Chip chip{dspic33fj256gp710(), pins, ChipOptions{4e6, 0.0}};
    std::map<std::string, std::uint32_t> symbols;

    explicit Bench33(const std::string& source, std::map<std::uint32_t, std::uint32_t> config = {}) {
        config.insert({{0xF80006, 0xFFF8}, {0xF80008, 0xFF7D}, {0xF8000A, 0xFF7F}});
        AssembleOptions options;
        for (const RegisterInfo& info : dspic33fj256gp710().registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble("        goto main\n" + source, options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        for (const auto& [address, word] : config)
            chip.load_word(address, word);
        symbols = program.symbols;
        chip.power_on();
    }
    /// Runs to the label, which must be reached within 50 ms; returns when.
    cosim::Time run_to_label(const std::string& label) {
        chip.stop_at(symbols.at(label));
        chip.run_until(chip.now() + 50 * cosim::kMillisecond);
        while (chip.stopped_at() && *chip.stopped_at() != symbols.at(label))
            chip.run_until(chip.now() + 50 * cosim::kMillisecond);
        if (!chip.stopped_at()) throw std::runtime_error("label not reached: " + label);
        return chip.now();
    }
    /// A word of RAM.
    int word(int address) { return chip.peek_data(static_cast<std::uint16_t>(address)); }
};

}  // namespace puckloop::dspic::test
