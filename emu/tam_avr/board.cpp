#include "emu/tam_avr/board.h"

#include "cosim/i2c/i2c_shared.h"

#include <algorithm>

namespace puckloop::tam {

namespace {

using cosim::Time;

constexpr std::uint32_t kBootLoader = 0x1FC00;  // byte address, with a boot section of 512 words
constexpr double kFullScale = 1024.0;
constexpr int kClocksOfByte = 9;
// PWR_CLEAR takes effect when the converter's output has fallen; the fact sheet does not say when. The chip
// is run in steps of half of this, so that it has never gone past that instant.
constexpr Time kSupplyFalls = cosim::kMillisecond;
constexpr Time kStep = kSupplyFalls / 2;
constexpr double kLowestBattery = 1.8;  // V, from which on the converter works
constexpr double kLowestModule = 2.1;   // V that the radio module runs on (S2C)
constexpr double kLowestDriver = 1.3;   // V below which the LED driver forgets: as the chip's (an assumption)

avr::ChipOptions chip_options(const BoardParameters& parameters) {
    avr::ChipOptions options;
    options.oscillator_hertz = parameters.resonator_hertz;
    options.ppm = parameters.resonator_ppm;
    options.avcc = options.aref = kSupplyVolts;
    return options;
}

}  // namespace

Board::Board(const BoardParameters& parameters, BoardListener& listener)
    : parameters_(parameters),
      listener_(listener),
      noise_(parameters.seed, parameters.name + "/adc"),
      barriers_{LightBarrier(parameters.barrier), LightBarrier(parameters.barrier)},
      chip_(avr::atmega1284p(), *this, chip_options(parameters)) {
    for (SignalId id = 0; id < kSignalCount; ++id)
        values_[id] = signals()[id].initial;
    battery_ = values_[kBattery];
    for (int i = 0; i < kBarriers; ++i)
        barriers_[static_cast<std::size_t>(i)].set_ambient(values_[static_cast<std::size_t>(kAmbient + i)]);
}

void Board::load(const image::AvrImage& image) {
    image::AvrImage fused = image;
    const bool has_boot_loader =
        std::any_of(image.flash.begin(), image.flash.end(), [](const image::ByteSegment& segment) {
            return segment.address + segment.bytes.size() > kBootLoader;
        });
    constexpr std::uint8_t kBootReset = 0xDE, kApplicationReset = 0xDF, kLocked = 0x0F;
    if (fused.fuses.empty()) fused.fuses = {0xFF, has_boot_loader ? kBootReset : kApplicationReset, 0xFD};
    if (!fused.lock_bits) fused.lock_bits = kLocked;
    chip_.load(fused);
    chip_.power_on();
}

void Board::run_until(Time until) {
    while (now_ < until) {
        if (!powered()) {
            now_ = until;
            return;
        }
        const Time step = std::min({until, now_ + kStep, off_at_});
        chip_.run_until(step);
        now_ = chip_.now();
        if (chip_.stopped_at()) return;
        if (now_ >= off_at_) switch_off(off_at_);
    }
}

void Board::set_signal(SignalId id, double value) {
    if (id >= kSignalCount || signals()[id].direction != cosim::SignalDirection::Input) return;
    const cosim::SignalInfo& info = signals()[id];
    if (id == kBattery) value = profile_.value_or(battery_ = value) - sag_;
    values_[id] = value > info.min ? std::min(value, info.max) : info.min;
    if (id < kAmbient)
        barriers_[id - kBarrier].set_interrupted(values_[id], now_);
    else if (id < kBattery)
        barriers_[id - kAmbient].set_ambient(values_[id]);
    if (!powered()) return;
    if (id == kBattery || id == kVdd) return update_supply();
    for (const PinUse& pin : wiring::kPins)
        if (pin.role == Role::Input && pin.signal == id) chip_.pins_changed(pin.port);
}

double Board::supply() const {
    return values_[kBattery] >= kLowestBattery ? std::min(kSupplyVolts, values_[kVdd]) : 0.0;
}

void Board::update_supply() {
    const double volts = supply();
    if (volts == chip_.supply()) return;
    chip_.set_supply(volts);
    if (volts < kLowestDriver) {
        leds_.reset();
        update_leds(now_);
    }
    report(kPower, volts >= kLowestModule ? 1.0 : 0.0, now_);
}

void Board::set_sag(double volts) {
    sag_ = volts;
    set_signal(kBattery, battery_);
}

void Board::set_battery(std::optional<double> volts) {
    if (volts == profile_) return;
    profile_ = volts;
    set_signal(kBattery, battery_);
}

void Board::set_ambient(const chip::AmbientShares& shares) {
    for (std::size_t i = 0; i < barriers_.size(); ++i)
        barriers_[i].set_glare(shares[i]);
}

void Board::uart_receive(int unit, const cosim::UartFrame& frame) {
    if (powered()) chip_.uart_receive(unit, frame);
}

void Board::reset_button() {
    if (!powered()) return;
    // RESET is the LED driver's as well.
    leds_.reset();
    update_leds(now_);
    chip_.external_reset();
}

void Board::reset_now(bool inside) {
    if (!powered()) return;
    leds_.reset();
    update_leds(inside ? time_of(chip_.cycle()) : now_);
    chip_.reset_now();
}

void Board::report(SignalId id, double value, Time now) {
    if (values_[id] == value) return;
    values_[id] = value;
    listener_.signal_changed(id, value, now);
}

void Board::switch_off(Time now) {
    off_at_ = cosim::kNever;
    leds_.reset();
    update_leds(now);
    for (const PinUse& pin : wiring::kPins)
        if (pin.role == Role::Output) report(pin.signal, 0.0, now);
    off_ = true;
    report(kPower, 0.0, now);
}

void Board::driven(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, avr::Cycle now) {
    const Time time = time_of(now);
    listener_.pins_driven(port, levels, driven, time);
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.role == Role::Output)
            report(pin.signal, levels & driven & 1u << pin.bit ? 1.0 : 0.0, time);
    if (values_[kPowerClear] != 0.0 && off_at_ == cosim::kNever) off_at_ = time + kSupplyFalls;
}

std::uint8_t Board::levels(avr::PortLetter port, std::uint8_t /*pull_ups*/, avr::Cycle /*now*/) {
    unsigned levels = 0xFF;
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.role == Role::Input && values_[pin.signal] < 0.5)
            levels &= ~(1u << pin.bit);
    return static_cast<std::uint8_t>(levels);
}

double Board::analog(int channel, avr::Cycle now) {
    double volts = 0.0;
    if (channel == kFrontChannel || channel == kBackChannel)
        volts = barriers_[channel == kFrontChannel ? 0 : 1].volts(time_of(now));
    else if (channel == kBatteryChannel)
        volts = values_[kBattery] * kBatteryDivider;
    if (parameters_.adc_noise_counts > 0)
        volts += parameters_.adc_noise_counts * noise_.normal() * kSupplyVolts / kFullScale;
    volts = std::clamp(volts, 0.0, kSupplyVolts);
    return analog_faults_.any() ? analog_faults_.apply(channel, volts / kSupplyVolts, now) * kSupplyVolts
                                : volts;
}

void Board::twi_phase(const cosim::I2cPhase& phase) {
    if (phase.kind == cosim::I2cPhaseKind::Start || phase.kind == cosim::I2cPhaseKind::Stop) {
        leds_.stop();
        update_leds(phase.start);
    }
    if (phase.kind == cosim::I2cPhaseKind::Stop) return listener_.twi_phase(phase);
    cosim::I2cPhase answer = phase;
    answer.kind = cosim::I2cPhaseKind::Acknowledge;
    switch (phase.kind) {
    case cosim::I2cPhaseKind::Start:
        addressed_ = leds_.start(phase.byte);
        answer.ack = addressed_;
        break;
    case cosim::I2cPhaseKind::Write:
        answer.ack = addressed_ && leds_.write(phase.byte);
        break;
    case cosim::I2cPhaseKind::Acknowledge:  // no byte follows: the driver follows whole bytes only
        return chip_.twi_answer_at(cosim::free_line(phase), phase.start + kClocksOfByte * phase.clock_period);
    default:
        answer.kind = cosim::I2cPhaseKind::Data;
        answer.byte = addressed_ ? leds_.read() : std::uint8_t{0xFF};
        break;
    }
    chip_.twi_answer_at(answer, phase.start + kClocksOfByte * phase.clock_period);
    answer.kind = phase.kind;
    listener_.twi_phase(answer);
}

void Board::update_leds(Time now) {
    for (int led = 0; led < kLeds; ++led) {
        const auto id = static_cast<SignalId>(kLed + led);
        if (values_[id] == leds_.duty(led)) continue;
        if (led == kInfraredLeft) barriers_[0].set_duty(leds_.duty(led), now);
        if (led == kInfraredRight) barriers_[1].set_duty(leds_.duty(led), now);
        report(id, leds_.duty(led), now);
    }
}

}  // namespace puckloop::tam
