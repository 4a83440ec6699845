#pragma once
// A chip that runs one of the driver programs (programs/drivers), with what the test put at its pins.

#include "base/random.h"
#include "emu/avr/chip/chip.h"
#include "emu/image/avr_image.h"

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::avr::test {

class DriverBench : public Pins {
  public:
    struct Edge {
        Pin pin;
        bool level = false;
        Cycle at = 0;
    };

    /// `program`: a file of programs/drivers without its ending.
    explicit DriverBench(const std::string& program, const ChipOptions& options = {})
        : image(image::load_avr_image(AVR_PROGRAMS "/" + program + ".elf", atmega1284p().image_part())),
          chip(atmega1284p(), *this, options) {
        chip.load(image);
    }
    /// Numbers for the program, before start().
    void put(std::size_t index, std::uint8_t value) {
        const std::size_t place = address("input") + index - atmega1284p().ram_start;
        chip.inside().core.ram()[place] = value;
    }
    void start() {
        chip.power_on();
        if (const auto end = image.find_code("finished")) chip.stop_at(*end);
    }
    /// To finished(), or for so long.
    bool finish(cosim::Time longest = 2 * cosim::kSecond) {
        chip.run_until(chip.now() + longest);
        return chip.stopped_at().has_value();
    }
    std::uint8_t result(std::size_t index) const {
        return chip.peek_data(static_cast<std::uint16_t>(address("result") + index));
    }
    unsigned stamp(std::size_t index) const {
        const auto at = static_cast<std::uint16_t>(address("stamps") + 2 * index);
        return chip.peek_data(at) | static_cast<unsigned>(chip.peek_data(static_cast<std::uint16_t>(at + 1)))
                                        << 8;
    }
    void set_pin(Pin pin, bool level) {
        std::uint8_t& levels = outside[static_cast<std::size_t>(pin.port)];
        levels = static_cast<std::uint8_t>(level ? levels | pin.mask() : levels & ~pin.mask());
        chip.pins_changed(pin.port);
    }
    /// What the chip drives at a pin; nothing of an input.
    std::optional<bool> driven_level(Pin pin) const {
        const auto& [levels, on] = shown[static_cast<std::size_t>(pin.port)];
        if (!(on & pin.mask())) return std::nullopt;
        return (levels & pin.mask()) != 0;
    }
    std::vector<Edge> edges_of(Pin pin) const {
        std::vector<Edge> found;
        for (const Edge& edge : edges)
            if (edge.pin.port == pin.port && edge.pin.number == pin.number) found.push_back(edge);
        return found;
    }

    void driven(PortLetter port, std::uint8_t levels, std::uint8_t on, Cycle now) override {
        auto& [old, was_on] = shown[static_cast<std::size_t>(port)];
        const auto changed = static_cast<std::uint8_t>((old ^ levels) & on & was_on);
        old = levels;
        was_on = on;
        for (std::uint8_t i = 0; i < 8; ++i)
            if (const Pin pin{port, i}; changed & pin.mask()) {
                edges.push_back({pin, (levels & pin.mask()) != 0, now});
                if (on_edge) on_edge(edges.back());
            }
    }
    std::uint8_t levels(PortLetter port, std::uint8_t, Cycle) override {
        return outside[static_cast<std::size_t>(port)];
    }
    double analog(int channel, Cycle) override { return volts[static_cast<std::size_t>(channel)]; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { frames.emplace_back(unit, frame); }
    void twi_phase(const cosim::I2cPhase& phase) override { phases.push_back(phase); }
    void twi_slave_answer(const cosim::I2cPhase& answer) override { answers.push_back(answer); }

    image::AvrImage image;
    std::array<std::uint8_t, 4> outside{0xFF, 0xFF, 0xFF, 0xFF};
    std::array<std::pair<std::uint8_t, std::uint8_t>, 4> shown{};  ///< levels, drivers that are on
    std::array<double, 8> volts{};
    std::vector<Edge> edges;
    std::function<void(const Edge&)> on_edge;  ///< a driven pin changed; may set `outside`
    std::vector<std::pair<int, cosim::UartFrame>> frames;
    std::vector<cosim::I2cPhase> phases, answers;
    Chip chip;

  private:
    std::uint16_t address(const std::string& symbol) const {
        return static_cast<std::uint16_t>(image.symbols.at(symbol).address);
    }
};

/// Two chips side by side, wires between their pins, in steps of a quarter of a microsecond.
struct Wire {
    Pin from, to;
};
inline void run_together(DriverBench& a, DriverBench& b, const std::vector<Wire>& from_a,
                         const std::vector<Wire>& from_b, cosim::Time time,
                         const std::function<bool()>& done) {
    const cosim::Time step = cosim::kMicrosecond / 4, end = a.chip.now() + time;
    const auto carry = [](DriverBench& from, DriverBench& to, const std::vector<Wire>& wires) {
        for (const Wire& wire : wires) {
            const bool level = from.driven_level(wire.from).value_or(true);
            const bool old = to.outside[static_cast<std::size_t>(wire.to.port)] & wire.to.mask();
            if (level != old) to.set_pin(wire.to, level);
        }
    };
    while (a.chip.now() < end && !done()) {
        a.chip.run_until(a.chip.now() + step);
        b.chip.run_until(a.chip.now());
        carry(a, b, from_a);
        carry(b, a, from_b);
    }
}

}  // namespace puckloop::avr::test
