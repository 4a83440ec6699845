#pragma once
// A dsPIC on the bench: the chip, what stands at its pins, and an I2C bus with nobody else on it.

#include "emu/pic/empty_bus.h"
#include "tools/exec/targets/pin_tap.h"
#include "tools/exec/targets/target.h"

#include <array>

namespace puckloop::exec {

/// Shared by the bare chip and the boards; they add the surroundings and the signals.
class DspicTarget : public Target {
  public:
    void load(const image::Image& image) override;
    void run_until(cosim::Time until) override;
    void uart_receive(int unit, const cosim::UartFrame& frame) override { chip_->uart_receive(unit, frame); }
    bool is_i2c_slave() const override { return device_.family_33f; }
    void i2c_slave_phase(const cosim::I2cPhase& phase) override {
        chip_->i2c_slave_phase(kI2cScriptUnit, phase);
    }
    cosim::Time earliest_i2c_answer() const override {
        return chip_->earliest_i2c_slave_answer(kI2cScriptUnit);
    }
    dspic::Chip& chip() override { return *chip_; }

  protected:
    DspicTarget(const dspic::DeviceInfo& device, const TargetOptions& options)
        : device_(device), options_(options) {}
    /// To be called once `tap` exists.
    void build(PinTap& tap);
    /// What the surroundings do about an I2C phase of the chip.
    void on_bus(int unit, const cosim::I2cPhase& phase) {
        buses_[static_cast<std::size_t>(unit - 1)].phase(phase);
    }
    /// Called when every instruction before cycle `now` has run.
    virtual void passed(dspic::Cycle /*now*/) {}

  private:
    const dspic::DeviceInfo& device_;
    TargetOptions options_;
    std::unique_ptr<dspic::Chip> chip_;
    std::array<pic::EmptyBus, 2> buses_;
    bool powered_ = false;
};

}  // namespace puckloop::exec
