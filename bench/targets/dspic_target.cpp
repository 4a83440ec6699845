#include "bench/targets/dspic_target.h"

#include "base/states/archive.h"
#include "cosim/core/message_state.h"
#include "cosim/i2c/i2c_shared.h"

#include <algorithm>

namespace puckloop::exec {

namespace {

/// A phase with what was on the wires when it was over.
cosim::I2cPhase over(cosim::I2cPhase phase, const cosim::I2cPhase& answer) {
    phase.stretch = answer.stretch;
    if (answer.kind == cosim::I2cPhaseKind::Acknowledge) phase.ack = answer.ack;
    if (answer.kind == cosim::I2cPhaseKind::Data) phase.byte = answer.byte;
    if (answer.kind == cosim::I2cPhaseKind::BusLost) phase.kind = answer.kind;
    return phase;
}

}  // namespace

void DspicTarget::build(PinTap& tap) {
    chip_ = std::make_unique<dspic::Chip>(device_, tap, options_.chip);
    chip_->set_skipping(options_.skip_idle);
    tap.use_clock(chip_->clock());
    const auto own = own_signals();
    signals_.assign(own.begin(), own.end());
    if (!options_.i2c_devices.empty()) make_devices();
}

void DspicTarget::make_devices() {
    const DeviceBus::Options options{options_.seed, options_.adc_noise_counts, options_.rab_log};
    devices_ = std::make_unique<DeviceBus>(options_.i2c_devices, options,
                                           [this](std::string_view name, double value, cosim::Time time) {
                                               listener_.signal_changed(name, value, time);
                                           });
    signals_.insert(signals_.end(), devices_->signals().begin(), devices_->signals().end());
}

double DspicTarget::signal(std::uint16_t id) const {
    const std::size_t own = own_signals().size();
    return id < own ? own_signal(id) : devices_->signal(id - own);
}

void DspicTarget::set_signal(std::uint16_t id, double value) {
    const std::size_t own = own_signals().size();
    if (id < own)
        set_own_signal(id, value);
    else
        devices_->set_signal(id - own, value, chip_->now());
}

image::Image DspicTarget::read_image(const std::string& file, std::string_view mcu) {
    image::Image image = Target::read_image(file, mcu);
    lines_ = image::source_lines(file);
    return image;
}

void DspicTarget::load(const image::Image& image) {
    chip_->load(image);
    chip_->power_on();
}

void DspicTarget::run_until(cosim::Time until) {
    while (chip_->now() < until) {
        const cosim::Time step = next_step(until);
        if (step > chip_->now()) chip_->run_until(step);
        if (chip_->stopped_at()) break;
        for (int unit = 1; unit <= 2; ++unit) {
            pic::EmptyBus& nobody = bus(unit).nobody;
            if (nobody.due() <= chip_->now()) answer(unit, nobody.take());
        }
        if (devices_ && devices_->due() <= chip_->now()) answer(kI2cDeviceUnit, devices_->take());
    }
    passed(chip_->cycle());
}

/// How far the chip may run before an answer may be due.
cosim::Time DspicTarget::next_step(cosim::Time until) {
    const cosim::Time now = chip_->now();
    cosim::Time step = until;
    for (const Bus& bus : buses_)
        step = std::min(step, std::max(bus.nobody.due(), now));
    if (devices_) step = devices_->advance(now, chip_->earliest_i2c(kI2cDeviceUnit), step);
    return step;
}

void DspicTarget::on_bus(int unit, const cosim::I2cPhase& phase) {
    // Clocks that are no byte's, the ninth of the byte before, or a low SDA found in it.
    if (phase.kind == cosim::I2cPhaseKind::Acknowledge || phase.kind == cosim::I2cPhaseKind::BusLost ||
        phase.kind == cosim::I2cPhaseKind::Data) {
        if (devices_ && unit == kI2cDeviceUnit)
            devices_->phase(phase);
        else if (phase.ack != 0)  // who is here follows whole bytes only
            chip_->i2c_answer_at(unit, cosim::free_line(phase), dspic::i2c_ninth_clock_end(phase));
        return;
    }
    std::optional<cosim::I2cPhase>& open = bus(unit).open;
    if (open) listener_.i2c_phase(unit, *open);
    open.reset();
    const cosim::Time answered = dspic::i2c_ninth_clock_end(phase);
    const OwnPhase own = own_i2c(unit, phase, chip_->clock().first_cycle_at(answered));
    if (own.answer) {
        listener_.i2c_phase(unit, over(phase, *own.answer));
        return chip_->i2c_answer_at(unit, *own.answer, answered);
    }
    if (own.ours) return listener_.i2c_phase(unit, phase);
    if (phase.kind == cosim::I2cPhaseKind::Stop)
        listener_.i2c_phase(unit, phase);
    else
        open = phase;
    if (devices_ && unit == kI2cDeviceUnit)
        devices_->phase(phase);
    else
        chip_->pause_at(bus(unit).nobody.phase(phase));
}

void DspicTarget::answer(int unit, const cosim::I2cPhase& phase) {
    if (std::optional<cosim::I2cPhase>& open = bus(unit).open) {
        const cosim::I2cPhase begun = *open;
        open.reset();
        listener_.i2c_phase(unit, over(begun, phase));
    }
    chip_->i2c_answer(unit, phase);
}

void DspicTarget::save_state(StateWriter& archive) {
    archive.part("chip", *chip_);
    for (Bus& bus : buses_)
        archive(bus.nobody, bus.open);
    save_own(archive);
}

void DspicTarget::restore_state(StateReader& archive) {
    archive.part("chip", *chip_);
    for (Bus& bus : buses_)
        archive(bus.nobody, bus.open);
    restore_own(archive);
}

void DspicTarget::finish() {
    if (devices_ && devices_report_.empty()) devices_report_ = devices_->finish();
}

}  // namespace puckloop::exec
