// `--mcu`: a chip on the bench with nothing connected. Idle levels: every digital input is held high (a weak
// pull-up), every analog input stands at 3800 counts of 4095 (near the rail, like a light sensor in a dim
// room), the supply is 3.3 V, UART and I2C lines are at rest. The stimulus may change any of it: `adc8 1200`,
// `RF1 0`.

#include "base/states/archive.h"
#include "bench/targets/dspic_target.h"

#include <fmt/format.h>

#include <vector>

namespace puckloop::exec {

namespace {

constexpr int kChannels30F = 16, kChannels33F = 32;
constexpr int kPins = 16;
constexpr double kFullScale = 4095;
constexpr double kIdleCounts = 3800;
constexpr double kSpan = 4096;
constexpr double kInsideCode = 0.25;
constexpr double kSupplyVolts = 3.3, kHighestVolts = 5.5;

std::string_view no_function(dspic::PortLetter, int) {
    return {};
}

class BareChip : public DspicTarget, private dspic::Pins {
  public:
    BareChip(const dspic::DeviceInfo& device, const TargetOptions& options, TargetListener& listener)
        : DspicTarget(device, options, listener),
          channels_(device.family_33f ? kChannels33F : kChannels30F),
          tap_(*this, listener, no_function) {
        for (int channel = 0; channel < channels_; ++channel)
            add({fmt::format("adc{}", channel), cosim::SignalDirection::Input, "counts", 0, kFullScale,
                 fmt::format("level at AN{}", channel), kIdleCounts},
                0, 0);
        for (const dspic::RegisterInfo& info : device.registers) {
            if (info.name.size() != 5 || !info.name.starts_with("TRIS")) continue;
            const char letter = info.name[4];
            if (letter < 'A' || letter > 'G') continue;
            for (int bit = 0; bit < kPins; ++bit)
                if (((info.implemented >> bit) & 1u) != 0)
                    add({fmt::format("R{}{}", letter, bit), cosim::SignalDirection::Input, "level", 0, 1,
                         fmt::format("level at pin R{}{} while it is an input", letter, bit), 1},
                        static_cast<std::size_t>(letter - 'A'), bit);
        }
        supply_id_ = signals_.size();
        add({"vdd", cosim::SignalDirection::Input, "V", 0, kHighestVolts,
             "supply; analog inputs keep their counts", kSupplyVolts},
            0, 0);
        levels_.fill(0xFFFF);
        build(tap_);
    }

  private:
    std::span<const cosim::SignalInfo> own_signals() const override { return signals_; }
    double own_signal(std::uint16_t id) const override { return values_[id]; }
    void set_own_signal(std::uint16_t id, double value) override {
        const cosim::SignalInfo& info = signals_[id];
        values_[id] = value > info.min ? (value < info.max ? value : info.max) : info.min;
        if (id < channels_) return;
        if (id == supply_id_) return chip().supply_changed();
        const auto [port, bit] = places_[id];
        const auto mask = static_cast<std::uint16_t>(1u << bit);
        levels_[port] =
            static_cast<std::uint16_t>(values_[id] >= 0.5 ? levels_[port] | mask : levels_[port] & ~mask);
        chip().pins_changed(static_cast<dspic::PortLetter>(port));
    }
    void save_own(StateWriter& archive) override { archive(values_, levels_); }
    void restore_own(StateReader& archive) override { archive(values_, levels_); }
    void add(cosim::SignalInfo info, std::size_t port, int bit) {
        values_.push_back(info.initial);
        places_.emplace_back(port, bit);
        signals_.push_back(std::move(info));
    }
    void driven(dspic::PortLetter, std::uint16_t, std::uint16_t, dspic::Cycle) override {}
    std::uint16_t levels(dspic::PortLetter port, dspic::Cycle) override {
        return levels_[static_cast<std::size_t>(port)];
    }
    double supply() const override { return values_[supply_id_]; }
    double analog(int channel, dspic::Cycle) override {
        return (static_cast<double>(static_cast<int>(values_[static_cast<std::size_t>(channel)])) +
                kInsideCode) /
               kSpan;
    }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override { on_bus(unit, phase); }

    int channels_;
    std::size_t supply_id_ = 0;
    std::vector<cosim::SignalInfo> signals_;
    std::vector<double> values_;
    std::vector<std::pair<std::size_t, int>> places_;
    std::array<std::uint16_t, 7> levels_{};
    PinTap tap_;
};

}  // namespace

std::unique_ptr<Target> make_bare_chip(std::string_view mcu, const TargetOptions& options,
                                       TargetListener& listener) {
    const std::string_view known = defaults_of(mcu, {}).mcu;  // throws for an unknown name
    const dspic::DeviceInfo* device = dspic::find_device(known);
    if (!device) return make_avr_chip(known, options, listener);
    return std::make_unique<BareChip>(*device, options, listener);
}

}  // namespace puckloop::exec
