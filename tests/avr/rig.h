#pragma once
// A chip for tests: program in assembly, everything at its pins recorded with the cycle.

#include "emu/avr/assembler/assembler.h"
#include "emu/avr/chip/chip.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::avr::test {

class Rig : public Pins {
  public:
    struct Edge {
        PortLetter port{};
        std::uint8_t levels = 0, driven = 0;
        Cycle at = 0;
    };

    /// The program begins at the reset vector. `fuses`: of the part.
    explicit Rig(const std::string& source, const ChipOptions& options = {})
        : program(assemble(source, {"test.s", &atmega1284p(), false})), chip(atmega1284p(), *this, options) {
        image::AvrImage image;
        for (const auto& [address, byte] : program.bytes)
            image.flash.push_back({address, {byte}});
        chip.load(image);
        chip.power_on();
        edges.clear();
    }

    /// Runs every instruction that starts before `cycle`.
    void run(Cycle cycle) { chip.run_until(chip.clock().time_of(cycle)); }
    std::uint8_t ram(const std::string& symbol) const {
        return chip.peek_data(static_cast<std::uint16_t>(program.symbol(symbol)));
    }
    std::uint8_t ram(std::uint16_t address) const { return chip.peek_data(address); }
    /// The cycles in which this pin changed its driven level.
    std::vector<Cycle> changes(Pin pin) const {
        std::vector<Cycle> cycles;
        bool level = false;
        for (const Edge& edge : edges)
            if (edge.port == pin.port && static_cast<bool>(edge.levels & pin.mask()) != level) {
                level = !level;
                cycles.push_back(edge.at);
            }
        return cycles;
    }
    void set_pin(Pin pin, bool level) {
        std::uint8_t& levels = outside[static_cast<std::size_t>(pin.port)];
        levels = static_cast<std::uint8_t>(level ? levels | pin.mask() : levels & ~pin.mask());
        chip.pins_changed(pin.port);
    }

    void driven(PortLetter port, std::uint8_t levels, std::uint8_t driven, Cycle now) override {
        edges.push_back({port, levels, driven, now});
    }
    std::uint8_t levels(PortLetter port, std::uint8_t, Cycle) override {
        return outside[static_cast<std::size_t>(port)];
    }
    double analog(int channel, Cycle) override { return volts[static_cast<std::size_t>(channel)]; }
    double comparator(bool negative, Cycle) override { return inputs[negative]; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { frames.emplace_back(unit, frame); }
    void twi_phase(const cosim::I2cPhase& phase) override { phases.push_back(phase); }
    void twi_slave_answer(const cosim::I2cPhase& answer) override { answers.push_back(answer); }
    std::optional<std::uint8_t> spi_exchange(std::uint8_t sent, Cycle now) override {
        exchanges.emplace_back(sent, now);
        if (spi_at_pins) return std::nullopt;
        return static_cast<std::uint8_t>(~sent);
    }

    Program program;
    std::array<std::uint8_t, 4> outside{0xFF, 0xFF, 0xFF, 0xFF};
    std::array<double, 8> volts{};
    std::array<double, 2> inputs{};
    std::vector<Edge> edges;
    std::vector<std::pair<int, cosim::UartFrame>> frames;
    std::vector<cosim::I2cPhase> phases, answers;
    std::vector<std::pair<std::uint8_t, Cycle>> exchanges;
    bool spi_at_pins = false;  ///< what comes in stands at MISO, bit by bit
    Chip chip;
};

}  // namespace puckloop::avr::test
