// `--mcu atmega1284p`: the chip alone. Idle levels: every digital input is held high (a weak pull-up), every
// analog input is at 0 V, nobody acknowledges on the two-wire bus. The stimulus may change any of it:
// `adc0 1.2`, `PD6 0`.

#include "tools/exec/targets/avr_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::exec {

namespace {

constexpr int kPinsOfPort = 8, kChannels = 8, kClocksOfByte = 9;
constexpr double kHighestVolts = 5.5;

avr::ChipOptions chip_options(const TargetOptions& options) {
    avr::ChipOptions chip;
    chip.oscillator_hertz = options.chip.crystal_hertz;
    chip.ppm = options.chip.ppm;
    return chip;
}

std::string_view no_function(avr::PortLetter, int) {
    return {};
}

class AvrChip final : public AvrTarget, private avr::Pins {
  public:
    AvrChip(const avr::DeviceInfo& device, const TargetOptions& options, TargetListener& listener)
        : AvrTarget(device, listener), chip_(device, *this, chip_options(options)) {
        for (int channel = 0; channel < kChannels; ++channel)
            add({fmt::format("adc{}", channel), cosim::SignalDirection::Input, "V", 0, kHighestVolts,
                 fmt::format("voltage at ADC{}", channel), 0});
        for (int port = 0; port < kPorts; ++port)
            for (int pin = 0; pin < kPinsOfPort; ++pin)
                add({fmt::format("P{}{}", static_cast<char>('A' + port), pin), cosim::SignalDirection::Input,
                     "level", 0, 1, "level at the pin while it is an input", 1});
        levels_.fill(0xFF);
        chip_.set_skipping(options.skip_idle);
    }

    std::span<const cosim::SignalInfo> signals() const override { return signals_; }
    double signal(std::uint16_t id) const override { return values_[id]; }
    void set_signal(std::uint16_t id, double value) override {
        values_[id] = std::clamp(value, signals_[id].min, signals_[id].max);
        if (id < kChannels) return chip_.pins_changed(avr::PortLetter::A);
        const auto pin = static_cast<unsigned>(id - kChannels);
        const auto mask = static_cast<std::uint8_t>(1u << pin % kPinsOfPort);
        std::uint8_t& levels = levels_[pin / kPinsOfPort];
        levels = static_cast<std::uint8_t>(values_[id] >= 0.5 ? levels | mask : levels & ~mask);
        chip_.pins_changed(static_cast<avr::PortLetter>(pin / kPinsOfPort));
    }

    void load(const image::Image&) override {
        chip_.load(firmware());
        chip_.power_on();
    }
    void run_until(cosim::Time until) override { chip_.run_until(until); }

  private:
    avr::Chip& avr() override { return chip_; }
    void add(cosim::SignalInfo info) {
        values_.push_back(info.initial);
        signals_.push_back(std::move(info));
    }
    void driven(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, avr::Cycle now) override {
        show_pins(port, levels, driven, chip_.clock().time_of(now), no_function);
    }
    std::uint8_t levels(avr::PortLetter port, std::uint8_t, avr::Cycle) override {
        return levels_[static_cast<std::size_t>(port)];
    }
    double analog(int channel, avr::Cycle) override { return values_[static_cast<std::size_t>(channel)]; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        listener().uart_sent(unit + 1, frame);
    }
    void twi_phase(const cosim::I2cPhase& phase) override {
        if (phase.kind == cosim::I2cPhaseKind::Stop) return listener().i2c_phase(kI2cDeviceUnit, phase);
        const bool reads = phase.kind == cosim::I2cPhaseKind::Read;
        cosim::I2cPhase nobody = phase;
        nobody.kind = reads ? cosim::I2cPhaseKind::Data : cosim::I2cPhaseKind::Acknowledge;
        nobody.byte = 0xFF;
        nobody.ack = 0;
        chip_.twi_answer_at(nobody, phase.start + kClocksOfByte * phase.clock_period);
        nobody.kind = phase.kind;
        listener().i2c_phase(kI2cDeviceUnit, nobody);
    }

    std::vector<cosim::SignalInfo> signals_;
    std::vector<double> values_;
    std::array<std::uint8_t, kPorts> levels_{};
    avr::Chip chip_;
};

}  // namespace

std::unique_ptr<Target> make_avr_chip(std::string_view mcu, const TargetOptions& options,
                                      TargetListener& listener) {
    return std::make_unique<AvrChip>(*avr::find_device(mcu), options, listener);
}

}  // namespace puckloop::exec
