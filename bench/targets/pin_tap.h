#pragma once
// Stands between a chip and what is around it, and reports to the bench every pin that changes.

#include "bench/targets/target.h"
#include "emu/dspic/peripherals/pins.h"

#include <array>
#include <functional>
#include <string_view>

namespace puckloop::exec {

class PinTap : public dspic::Pins {
  public:
    /// `function_of(port, bit)` names what a pin is for, or "".
    using FunctionOf = std::string_view (*)(dspic::PortLetter port, int bit);

    PinTap(dspic::Pins& inner, TargetListener& listener, FunctionOf function_of)
        : inner_(inner), listener_(listener), function_of_(function_of) {}
    /// The chip's clock, known only once the chip exists.
    void use_clock(const cosim::ClockDomain& clock) { clock_ = &clock; }

    void driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven,
                dspic::Cycle now) override;
    std::uint16_t levels(dspic::PortLetter port, dspic::Cycle now) override {
        return inner_.levels(port, now);
    }
    std::uint16_t quiet_levels(dspic::PortLetter port, dspic::Cycle now) override {
        return inner_.quiet_levels(port, now);
    }
    dspic::Cycle next_edge(dspic::PortLetter port, std::uint16_t monitored,
                           dspic::Cycle after) const override {
        return inner_.next_edge(port, monitored, after);
    }
    double analog(int channel, dspic::Cycle now) override { return inner_.analog(channel, now); }
    std::uint64_t analog_epoch(dspic::Cycle from) override { return inner_.analog_epoch(from); }
    void uart_sent(int unit, const cosim::UartFrame& frame) override;
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override;
    void i2c_slave_answer(int unit, const cosim::I2cPhase& answer) override;
    std::uint16_t spi_exchange(int unit, std::uint16_t sent, int bits, dspic::Cycle now) override {
        return inner_.spi_exchange(unit, sent, bits, now);
    }
    std::uint16_t dci_exchange(const dspic::DciWord& word, dspic::Cycle now) override {
        return inner_.dci_exchange(word, now);
    }
    dspic::DciMaster dci_master() const override { return inner_.dci_master(); }
    double supply() const override { return inner_.supply(); }
    dspic::OutsidePin outside(dspic::PortLetter port, int bit) const override {
        return inner_.outside(port, bit);
    }
    void output_compare_changed(int unit, dspic::Cycle now) override {
        inner_.output_compare_changed(unit, now);
    }
    bool wants_pwm_edges(int unit) const override { return inner_.wants_pwm_edges(unit); }

  private:
    struct PortState {
        std::uint16_t levels = 0;
        std::uint16_t driven = 0;
    };
    dspic::Pins& inner_;
    TargetListener& listener_;
    FunctionOf function_of_;
    const cosim::ClockDomain* clock_ = nullptr;
    std::array<PortState, 7> ports_{};
};

}  // namespace puckloop::exec
