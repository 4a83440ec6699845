// `--mcu atmega1284p`: the chip alone. Idle levels: every digital input is held high (a weak pull-up), every
// analog input is at 0 V, nobody acknowledges on the two-wire bus. The stimulus may change any of it:
// `adc0 1.2`, `PD6 0`. USART0 and USART1 are the bench's uart1 and uart2.

#include "emu/avr/chip.h"
#include "emu/pic/empty_bus.h"
#include "tools/exec/targets/target.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>

namespace puckloop::exec {

namespace {

constexpr int kPorts = 4, kPinsOfPort = 8, kChannels = 8;
constexpr double kHighestVolts = 5.5;
constexpr std::size_t kShownInText = 10;

std::string hexadecimal(std::uint32_t address) {
    return fmt::format("0x{:04x}", address);
}

avr::ChipOptions chip_options(const TargetOptions& options) {
    avr::ChipOptions chip;
    chip.oscillator_hertz = options.chip.crystal_hertz;
    chip.ppm = options.chip.ppm;
    return chip;
}

class AvrChip : public Target, private avr::Pins {
  public:
    AvrChip(const avr::DeviceInfo& device, const TargetOptions& options, TargetListener& listener)
        : device_(device), listener_(listener), chip_(device, *this, chip_options(options)) {
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

    image::Image read_image(const std::string& file, std::string_view) override {
        firmware_ = image::load_avr_image(file, device_.image_part());
        image::Image image;
        image.file = firmware_.file;
        image.format = firmware_.format;
        image.sha256 = firmware_.sha256;
        image.chip = firmware_.chip;
        image.symbols = firmware_.symbols;
        return image;
    }
    void load(const image::Image&) override {
        chip_.load(firmware_);
        chip_.power_on();
    }
    void run_until(cosim::Time until) override {
        while (true) {
            const cosim::Time answer = std::max(bus_.due(), chip_.now());
            if (answer >= until) break;
            chip_.run_until(answer);
            if (chip_.stopped_at()) return;
            chip_.twi_answer(bus_.take());
        }
        chip_.run_until(until);
    }
    void uart_receive(int unit, const cosim::UartFrame& frame) override {
        chip_.uart_receive(unit - 1, frame);
    }
    bool is_i2c_slave() const override { return false; }
    void i2c_slave_phase(const cosim::I2cPhase&) override {}
    cosim::Time earliest_i2c_answer() const override { return cosim::kNever; }

    const cosim::ClockDomain& clock() override { return chip_.clock(); }
    cosim::Time now() override { return chip_.now(); }
    std::uint32_t pc() override { return chip_.pc(); }
    void stop_at(std::uint32_t pc) override { chip_.stop_at(pc); }
    bool stopped() override { return chip_.stopped_at().has_value(); }
    bool uart_enabled(int unit) override { return chip_.uart_listens(unit - 1); }
    dspic::UartCounters uart_counters(int unit) override { return chip_.uart_counters(unit - 1); }
    std::size_t resets() override { return chip_.report().resets.size(); }
    std::string chip_json() override;
    std::string chip_text() override;
    std::vector<std::string> warnings() override;
    std::optional<std::string> hang() override { return std::nullopt; }
    void reset_button() override { chip_.external_reset(); }
    bool keeps_memory() const override { return false; }

  private:
    void add(cosim::SignalInfo info) {
        values_.push_back(info.initial);
        signals_.push_back(std::move(info));
    }
    double seconds(avr::Cycle cycle) {
        return static_cast<double>(chip_.clock().time_of(cycle)) / static_cast<double>(cosim::kSecond);
    }

    void driven(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, avr::Cycle now) override {
        auto& [old_levels, old_driven] = shown_[static_cast<std::size_t>(port)];
        const unsigned changed = (old_levels ^ levels) | (old_driven ^ driven);
        old_levels = levels;
        old_driven = driven;
        for (int pin = 0; pin < kPinsOfPort; ++pin) {
            if ((changed >> pin & 1u) == 0) continue;
            std::optional<bool> level;
            if ((driven >> pin & 1u) != 0) level = (levels >> pin & 1u) != 0;
            listener_.pin_changed(fmt::format("P{}{}", static_cast<char>('A' + static_cast<int>(port)), pin),
                                  "", level, chip_.clock().time_of(now));
        }
    }
    std::uint8_t levels(avr::PortLetter port, std::uint8_t, avr::Cycle) override {
        return levels_[static_cast<std::size_t>(port)];
    }
    double analog(int channel, avr::Cycle) override { return values_[static_cast<std::size_t>(channel)]; }
    void uart_sent(int unit, const cosim::UartFrame& frame) override { listener_.uart_sent(unit + 1, frame); }
    void twi_phase(const cosim::I2cPhase& phase) override {
        listener_.i2c_phase(kI2cDeviceUnit, phase);
        bus_.phase(phase);
    }
    const avr::DeviceInfo& device_;
    TargetListener& listener_;
    std::vector<cosim::SignalInfo> signals_;
    std::vector<double> values_;
    std::array<std::uint8_t, kPorts> levels_{};
    std::array<std::pair<std::uint8_t, std::uint8_t>, kPorts> shown_{};
    pic::EmptyBus bus_;  ///< nobody is on the two-wire bus
    image::AvrImage firmware_;
    avr::Chip chip_;
};

std::string AvrChip::chip_json() {
    using Json = nlohmann::ordered_json;
    const avr::ChipReport report = chip_.report();
    Json json;
    json["cycles"] = report.cycles;
    json["instructions"] = report.instructions;
    json["resets"] = Json::array();
    for (const avr::ResetRecord& reset : report.resets)
        json["resets"].push_back({{"time_s", seconds(reset.cycle)},
                                  {"cause", std::string(avr::to_string(reset.cause))},
                                  {"pc", hexadecimal(reset.pc)}});
    json["unmodelled"] = Json::array();
    for (const avr::UnmodelledTouch& touch : report.unmodelled)
        json["unmodelled"].push_back({{"name", touch.name},
                                      {"address", hexadecimal(touch.address)},
                                      {"pc", hexadecimal(touch.pc)},
                                      {"access", touch.write ? "write" : "read"}});
    json["warnings"] = warnings();
    return json.dump();
}

std::string AvrChip::chip_text() {
    const avr::ChipReport report = chip_.report();
    std::string text = fmt::format("work: {} cycles, {} instructions\n", report.cycles, report.instructions);
    for (std::size_t i = 0; i < report.resets.size() && i < kShownInText; ++i)
        text += fmt::format("reset: {} at {:.6f} s, pc {}\n", avr::to_string(report.resets[i].cause),
                            seconds(report.resets[i].cycle), hexadecimal(report.resets[i].pc));
    if (report.resets.size() > kShownInText) text += fmt::format("resets: {} in all\n", report.resets.size());
    return text;
}

std::vector<std::string> AvrChip::warnings() {
    const avr::ChipReport report = chip_.report();
    std::vector<std::string> lines;
    for (const avr::UnmodelledTouch& touch : report.unmodelled)
        lines.push_back(
            fmt::format("{} {}, which no model is behind, at pc {}", touch.write ? "writes" : "reads",
                        touch.name.empty() ? hexadecimal(touch.address) : touch.name, hexadecimal(touch.pc)));
    for (const avr::ChipWarning& warning : report.warnings)
        lines.push_back(fmt::format("{}, at pc {}", warning.text, hexadecimal(warning.pc)));
    return lines;
}

}  // namespace

std::unique_ptr<Target> make_avr_chip(std::string_view mcu, const TargetOptions& options,
                                      TargetListener& listener) {
    return std::make_unique<AvrChip>(*avr::find_device(mcu), options, listener);
}

}  // namespace puckloop::exec
