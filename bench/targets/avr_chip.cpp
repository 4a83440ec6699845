// `--mcu atmega1284p`: the chip alone. Idle levels: every digital input is held high (a weak pull-up), every
// analog input is at 0 V, the supply is 5 V, a watch crystal of 32 768 Hz is at TOSC1. The stimulus may
// change any of it: `adc0 1.2`, `PD6 0`. The two-wire bus is empty, unless devices are put on it or a script
// is its master.

#include "base/states/archive.h"
#include "bench/bus/device_bus.h"
#include "bench/targets/avr_target.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::exec {

namespace {

constexpr int kPinsOfPort = 8, kChannels = 8, kTwiClocksOfByte = 9;
constexpr double kHighestAvrVolts = 5.5, kAvrSupplyVolts = 5.0;
constexpr std::uint32_t kWatchHertz = 32'768;

avr::ChipOptions chip_options(const TargetOptions& options) {
    avr::ChipOptions chip;
    chip.oscillator_hertz = options.chip.crystal_hertz;
    chip.ppm = options.chip.ppm;
    chip.avcc = chip.aref = kAvrSupplyVolts;
    chip.watch_hertz = kWatchHertz;
    return chip;
}

std::string_view no_function(avr::PortLetter, int) {
    return {};
}

class AvrChip final : public AvrTarget, private avr::Pins {
  public:
    AvrChip(const avr::DeviceInfo& device, const TargetOptions& options, TargetListener& listener)
        : AvrTarget(device, options.fuses, listener), chip_(device, *this, chip_options(options)) {
        using enum cosim::SignalDirection;
        for (int channel = 0; channel < kChannels; ++channel)
            add({fmt::format("adc{}", channel), Input, "V", 0, kHighestAvrVolts,
                 fmt::format("voltage at ADC{}", channel), 0});
        for (int port = 0; port < kPorts; ++port)
            for (int pin = 0; pin < kPinsOfPort; ++pin)
                add({fmt::format("P{}{}", static_cast<char>('A' + port), pin), Input, "level", 0, 1,
                     "level at the pin while it is an input", 1});
        add({"ain0", Input, "V", 0, kHighestAvrVolts, "voltage at the comparator's AIN0", 0});
        add({"ain1", Input, "V", 0, kHighestAvrVolts, "voltage at the comparator's AIN1", 0});
        add({"vcc", Input, "V", 0, kHighestAvrVolts, "supply, and AVCC; AREF stays at 5 V", kAvrSupplyVolts});
        levels_.fill(0xFF);
        chip_.set_skipping(options.skip_idle);
        if (options.i2c_devices.empty()) return;
        const DeviceBus::Options bus{options.seed, options.adc_noise_counts, options.rab_log};
        devices_ = std::make_unique<DeviceBus>(options.i2c_devices, bus,
                                               [this](std::string_view name, double value, cosim::Time time) {
                                                   this->listener().signal_changed(name, value, time);
                                               });
        own_signals_ = signals_.size();
        signals_.insert(signals_.end(), devices_->signals().begin(), devices_->signals().end());
    }

    std::span<const cosim::SignalInfo> signals() const override { return signals_; }
    double signal(std::uint16_t id) const override {
        return id < values_.size() ? values_[id] : devices_->signal(id - own_signals_);
    }
    void set_signal(std::uint16_t id, double value) override {
        if (id >= values_.size()) return devices_->set_signal(id - own_signals_, value, chip_.now());
        values_[id] = std::clamp(value, signals_[id].min, signals_[id].max);
        if (id < kChannels) return chip_.pins_changed(avr::PortLetter::A);
        if (id == kSupply) return chip_.set_supply(values_[id]);
        if (id >= kComparator) return chip_.pins_changed(avr::PortLetter::B);
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
    void run_until(cosim::Time until) override {
        if (!devices_) return chip_.run_until(until);
        while (chip_.now() < until) {
            const cosim::Time now = chip_.now();
            const cosim::Time step = devices_->advance(now, std::max(now, chip_.wakes()), until);
            if (step > now) chip_.run_until(step);
            if (chip_.stopped_at()) return;
            if (devices_->due() <= step) answer(devices_->take());
        }
    }
    bool saves() const override { return !devices_; }
    void save_state(StateWriter& archive) override {
        archive.part("chip", chip_);
        archive(values_, levels_);
    }
    void restore_state(StateReader& archive) override {
        archive.part("chip", chip_);
        archive(values_, levels_);
    }
    bool is_i2c_slave() const override { return true; }
    void i2c_slave_phase(const cosim::I2cPhase& phase) override { chip_.twi_slave_phase(phase); }
    cosim::Time earliest_i2c_answer() const override { return chip_.earliest_twi_slave_answer(); }
    std::string i2c_devices_report() const override { return devices_report_; }
    void finish() override {
        if (devices_ && devices_report_.empty()) devices_report_ = devices_->finish();
    }

  private:
    static constexpr std::uint16_t kComparator = kChannels + kPorts * kPinsOfPort, kSupply = kComparator + 2;

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
    double comparator(bool negative, avr::Cycle) override { return values_[kComparator + negative]; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override {
        listener().uart_sent(unit + 1, frame);
    }
    void twi_phase(const cosim::I2cPhase& phase) override {
        if (devices_) return to_devices(phase);
        if (phase.kind == cosim::I2cPhaseKind::Stop) return listener().i2c_phase(kI2cDeviceUnit, phase);
        const bool reads = phase.kind == cosim::I2cPhaseKind::Read;
        cosim::I2cPhase nobody = phase;
        nobody.kind = reads ? cosim::I2cPhaseKind::Data : cosim::I2cPhaseKind::Acknowledge;
        nobody.byte = 0xFF;
        nobody.ack = 0;
        chip_.twi_answer_at(nobody, phase.start + kTwiClocksOfByte * phase.clock_period);
        nobody.kind = phase.kind;
        listener().i2c_phase(kI2cDeviceUnit, nobody);
    }
    void twi_slave_answer(const cosim::I2cPhase& answer) override {
        constexpr int kClocksToAnswer = 8;
        listener().i2c_answered(answer,
                                answer.start + kClocksToAnswer * answer.clock_period + answer.stretch);
    }

    /// The line of the log is written when the phase is answered, or given up.
    void to_devices(const cosim::I2cPhase& phase) {
        if (phase.kind == cosim::I2cPhaseKind::Acknowledge) return devices_->phase(phase);  // no byte's
        if (open_) listener().i2c_phase(kI2cDeviceUnit, *open_);
        open_.reset();
        if (phase.kind == cosim::I2cPhaseKind::Stop)
            listener().i2c_phase(kI2cDeviceUnit, phase);
        else
            open_ = phase;
        devices_->phase(phase);
    }
    void answer(const cosim::I2cPhase& phase) {
        if (open_) {
            cosim::I2cPhase over = *open_;
            open_.reset();
            over.stretch = phase.stretch;
            if (phase.kind == cosim::I2cPhaseKind::Acknowledge) over.ack = phase.ack;
            if (phase.kind == cosim::I2cPhaseKind::Data) over.byte = phase.byte;
            if (phase.kind == cosim::I2cPhaseKind::BusLost) over.kind = phase.kind;
            listener().i2c_phase(kI2cDeviceUnit, over);
        }
        chip_.twi_answer(phase);
    }

    std::vector<cosim::SignalInfo> signals_;
    std::vector<double> values_;
    std::array<std::uint8_t, kPorts> levels_{};
    std::unique_ptr<DeviceBus> devices_;
    std::size_t own_signals_ = 0;
    std::optional<cosim::I2cPhase> open_;  ///< still to be answered by a device
    std::string devices_report_;
    avr::Chip chip_;
};

}  // namespace

std::unique_ptr<Target> make_avr_chip(std::string_view mcu, const TargetOptions& options,
                                      TargetListener& listener) {
    return std::make_unique<AvrChip>(*avr::find_device(mcu), options, listener);
}

}  // namespace puckloop::exec
