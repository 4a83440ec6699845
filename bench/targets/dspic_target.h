#pragma once
// A dsPIC on the bench: the chip, what stands at its pins, and its I2C buses: with the devices that the user
// put on module 1's, with nobody else otherwise.

#include "bench/bus/device_bus.h"
#include "bench/targets/pin_tap.h"
#include "bench/targets/target.h"
#include "emu/image/line_table.h"
#include "emu/pic/empty_bus.h"

#include <array>

namespace puckloop::exec {

/// Shared by the bare chip and the boards; they add the surroundings and the signals.
class DspicTarget : public Target {
  public:
    image::Image read_image(const std::string& file, std::string_view mcu) override;
    void load(const image::Image& image) override;
    void run_until(cosim::Time until) override;
    void uart_receive(int unit, const cosim::UartFrame& frame) override { chip_->uart_receive(unit, frame); }
    bool is_i2c_slave() const override { return true; }
    void i2c_slave_phase(const cosim::I2cPhase& phase) override {
        chip_->i2c_slave_phase(kI2cScriptUnit, phase);
    }
    cosim::Time earliest_i2c_answer() const override {
        return chip_->earliest_i2c_slave_answer(kI2cScriptUnit);
    }
    /// Those of the surroundings, then those of the devices on the bus.
    std::span<const cosim::SignalInfo> signals() const final { return signals_; }
    double signal(std::uint16_t id) const final;
    void set_signal(std::uint16_t id, double value) final;
    std::string i2c_devices_report() const override { return devices_report_; }
    void finish() override;
    std::string source_line(std::uint32_t pc) const override { return lines_.at(pc); }
    std::vector<std::uint32_t> addresses_of(std::string_view file, std::uint32_t line) const override {
        return lines_.addresses(file, line);
    }
    const image::LineTable& lines() const override { return lines_; }
    bool saves() const override { return !devices_; }
    void save_state(StateWriter& archive) override;
    void restore_state(StateReader& archive) override;
    dspic::Chip& chip() override { return *chip_; }

  protected:
    DspicTarget(const dspic::DeviceInfo& device, const TargetOptions& options, TargetListener& listener)
        : device_(device), options_(options), listener_(listener) {}
    /// To be called once `tap` and the surroundings' signals exist. Throws InputError for devices that cannot
    /// be.
    void build(PinTap& tap);
    /// What the surroundings do about an I2C phase of the chip.
    void on_bus(int unit, const cosim::I2cPhase& phase);
    /// Takes part in a phase in place of the bus: something that the board itself carries.
    struct OwnPhase {
        bool ours = false;  ///< the bus need not hear of it
        std::optional<cosim::I2cPhase> answer{};
    };
    virtual OwnPhase own_i2c(int /*unit*/, const cosim::I2cPhase& /*phase*/, dspic::Cycle /*answered*/) {
        return {};
    }
    /// Called when every instruction before cycle `now` has run.
    virtual void passed(dspic::Cycle /*now*/) {}

    virtual std::span<const cosim::SignalInfo> own_signals() const = 0;
    virtual double own_signal(std::uint16_t id) const = 0;
    virtual void set_own_signal(std::uint16_t id, double value) = 0;
    /// The surroundings' part of save_state() and restore_state().
    virtual void save_own(StateWriter& archive) = 0;
    virtual void restore_own(StateReader& archive) = 0;

  private:
    struct Bus {
        pic::EmptyBus nobody;
        std::optional<cosim::I2cPhase> open;  ///< still to be answered
    };
    Bus& bus(int unit) { return buses_[static_cast<std::size_t>(unit - 1)]; }
    void make_devices();
    cosim::Time next_step(cosim::Time until);
    void answer(int unit, const cosim::I2cPhase& phase);

    const dspic::DeviceInfo& device_;
    TargetOptions options_;
    TargetListener& listener_;
    std::unique_ptr<dspic::Chip> chip_;
    std::array<Bus, 2> buses_;
    std::unique_ptr<DeviceBus> devices_;  ///< on the bus of module kI2cDeviceUnit
    std::vector<cosim::SignalInfo> signals_;
    std::string devices_report_;
    image::LineTable lines_;  ///< of the image, where it has them
};

/// What the parameters of all boards have in common.
template <class Parameters>
Parameters board_parameters(const TargetOptions& options) {
    Parameters parameters;
    parameters.seed = options.seed;
    parameters.crystal_hertz = options.chip.crystal_hertz;
    parameters.crystal_ppm = options.chip.ppm;
    parameters.adc_noise_counts = options.adc_noise_counts;
    return parameters;
}

}  // namespace puckloop::exec
