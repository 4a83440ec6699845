#pragma once
// A TAM's board for tests: signals, bytes and bus phases recorded with their times.

#include "emu/avr/assembler/assembler.h"
#include "emu/tam_avr/board.h"

#include <string>
#include <utility>
#include <vector>

namespace puckloop::tam::test {

inline image::AvrImage assembled(const std::string& source) {
    const avr::Program program = avr::assemble(source, {"test.s", &avr::atmega1284p(), false});
    image::AvrImage image;
    for (const auto& [address, byte] : program.bytes)
        image.flash.push_back({address, {byte}});
    return image;
}

class Rig : public BoardListener {
  public:
    struct Change {
        SignalId id = 0;
        double value = 0.0;
        cosim::Time at = 0;
    };

    explicit Rig(const BoardParameters& parameters = quiet()) : board(parameters, *this) {}

    /// Parameters without ADC noise.
    static BoardParameters quiet() {
        BoardParameters parameters;
        parameters.adc_noise_counts = 0;
        return parameters;
    }

    void signal_changed(SignalId id, double value, cosim::Time now) override {
        changes.push_back({id, value, now});
    }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { frames.emplace_back(unit, frame); }
    void twi_phase(const cosim::I2cPhase& phase) override { phases.push_back(phase); }

    /// Changes of one signal.
    std::vector<Change> of(SignalId id) const {
        std::vector<Change> found;
        for (const Change& change : changes)
            if (change.id == id) found.push_back(change);
        return found;
    }

    std::vector<Change> changes;
    std::vector<std::pair<int, cosim::UartFrame>> frames;
    std::vector<cosim::I2cPhase> phases;
    Board board;
};

}  // namespace puckloop::tam::test
