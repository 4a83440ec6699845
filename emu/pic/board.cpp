#include "emu/pic/board.h"

#include "emu/pic/pin_table.h"

#include <algorithm>
#include <cmath>

namespace puckloop::pic {

namespace {

constexpr double kFullScale = 4095.0;
constexpr double kSpan = 4096.0;
// Where inside its code a value is put, so that neither truncation nor rounding moves it to the next one.
constexpr double kInsideCode = 0.25;
constexpr double kRegulated = 3.3, kDropout = 0.1;  // V, of the board's supply (an assumption)
constexpr double kPllOverCycle = 2.0;               // PLL x8, four oscillator periods a cycle

double cycles(double seconds, const BoardParameters& parameters) {
    return seconds * parameters.crystal_hertz * kPllOverCycle;
}

/// One for each phototransistor.
std::array<LightInput, kProximityCount> lights(double time_constant) {
    const LightInput one{time_constant};
    return {one, one, one, one, one, one, one, one};
}

StepperDecoder motor(StepSense sense, const BoardParameters& parameters) {
    return {sense, static_cast<dspic::Cycle>(std::ceil(cycles(parameters.coil_settle_s, parameters)))};
}

/// The signal that a name shares its input with: adc2 is mic0, adc8 is ambient0.
SignalId canonical(SignalId id) {
    if (id >= kAdc && id < kAdc + kAdcCount) return kAnalogWiring[static_cast<std::size_t>(id - kAdc)];
    return id;
}

double clipped(SignalId id, double value) {
    const cosim::SignalInfo& info = signals()[id];
    if (!(value > info.min)) return info.min;
    return value > info.max ? info.max : value;
}

}  // namespace

Board::Board(const BoardParameters& parameters, BoardListener& listener)
    : parameters_(parameters),
      listener_(listener),
      phototransistor_noise_(parameters.phototransistor_noise_counts.value_or(parameters.adc_noise_counts)),
      noise_(parameters.seed, parameters.name + "/adc"),
      emitters_{Emitter{cycles(parameters.light_time_constant_s, parameters)},
                Emitter{cycles(parameters.light_time_constant_s, parameters)},
                Emitter{cycles(parameters.light_time_constant_s, parameters)},
                Emitter{cycles(parameters.light_time_constant_s, parameters)}},
      lights_(lights(cycles(parameters.light_time_constant_s, parameters))),
      microphones_{Microphone{parameters.seed, parameters.name + "/mic0"},
                   Microphone{parameters.seed, parameters.name + "/mic1"},
                   Microphone{parameters.seed, parameters.name + "/mic2"}},
      sounds_{SoundInput{cycles(kSoundPeriod, parameters)}, SoundInput{cycles(kSoundPeriod, parameters)},
              SoundInput{cycles(kSoundPeriod, parameters)}},
      motors_{motor(StepSense::LeftMotor, parameters), motor(StepSense::RightMotor, parameters)} {
    for (SignalId id = 0; id < kSignalCount; ++id)
        values_[id].value = values_[id].before = signals()[id].initial;
    battery_ = values_[kBatteryVoltage].value;
    values_[kSelector].value = clipped(kSelector, parameters.selector);
    place_levels();
}

std::optional<dspic::PortLetter> Board::set_signal(SignalId id, double value, dspic::Cycle now) {
    if (id >= kSignalCount || signals()[id].direction != cosim::SignalDirection::Input) return std::nullopt;
    if (id == kBatteryVoltage) battery_ = value;
    const double wanted = clipped(id, id == kBatteryVoltage ? profile_.value_or(value) - sag_ : value);
    Input& input = values_[canonical(id)];
    input.before = input.at(now);
    input.value = wanted;
    input.since = now;
    analog_changed();
    if (id >= kInfraredLight && id < kInfraredLight + kProximityCount)
        lights_[static_cast<std::size_t>(id - kInfraredLight)].set(wanted, now);
    if (id >= kSound && id < kSound + kMicrophoneCount)
        sounds_[static_cast<std::size_t>(id - kSound)].set(wanted, now);
    if (id == kBatteryVoltage) values_[kBatteryLow].value = wanted < parameters_.battery_low_volts ? 1 : 0;
    const std::array<std::uint16_t, kPorts> before = levels_;
    place_levels();
    for (std::size_t port = 0; port < kPorts; ++port)
        if (levels_[port] != before[port]) return static_cast<dspic::PortLetter>(port);
    return std::nullopt;
}

std::optional<dspic::PortLetter> Board::set_sag(double volts, dspic::Cycle now) {
    if (volts == sag_) return std::nullopt;
    sag_ = volts;
    return set_signal(kBatteryVoltage, battery_, now);
}

std::optional<dspic::PortLetter> Board::set_battery(std::optional<double> volts, dspic::Cycle now) {
    if (volts == profile_) return std::nullopt;
    profile_ = volts;
    return set_signal(kBatteryVoltage, battery_, now);
}

void Board::set_held(int motor, bool held, dspic::Cycle now) {
    if (now > 0) settle(now - 1);
    motors_[static_cast<std::size_t>(motor)].set_held(held);
}

double Board::supply() const {
    return std::min(kRegulated, values_[kBatteryVoltage].value - kDropout);
}

double Board::signal(SignalId id) const {
    return values_[canonical(id)].value;
}

void Board::place_levels() {
    levels_ = {};
    for (const PinUse& pin : wiring::kPins) {
        bool high = pin.role == Role::PulledHigh;
        if (pin.role == Role::Input || pin.role == Role::InputLow) {
            const unsigned value = static_cast<unsigned>(values_[pin.signal].value);
            high = ((value >> pin.signal_bit) & 1u) != (pin.role == Role::InputLow ? 1u : 0u);
        }
        if (high) levels_[static_cast<std::size_t>(pin.port)] |= static_cast<std::uint16_t>(1u << pin.bit);
    }
}

void Board::driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven, dspic::Cycle now) {
    settle(now);
    if (port == wiring::kLinePort) watch_line(levels, driven, now);
    std::uint16_t& outputs = outputs_[static_cast<std::size_t>(port)];
    const std::uint16_t high = levels & driven;  // a pin that is an input drives nothing: all are active high
    const unsigned changed = outputs ^ high;
    outputs = high;
    if (changed == 0) return;
    bool coils_changed = false;
    for (const PinUse& pin : wiring::kPins) {
        if (pin.port != port || ((changed >> pin.bit) & 1u) == 0) continue;
        if (pin.role == Role::Output) drive(pin.signal, ((high >> pin.bit) & 1u) != 0, now);
        coils_changed |= pin.role == Role::Coil;
    }
    if (!coils_changed) return;
    std::array<unsigned, 2> patterns{};
    for (const PinUse& pin : wiring::kPins)
        if (pin.role == Role::Coil)
            patterns[pin.signal == kWheelLeft ? 0 : 1] |= ((high >> pin.bit) & 1u) << pin.signal_bit;
    for (std::size_t i = 0; i < patterns.size(); ++i)
        motors_[i].coils(static_cast<std::uint8_t>(patterns[i]), now);
}

void Board::watch_line(std::uint16_t levels, std::uint16_t driven, dspic::Cycle now) {
    const bool low = ((driven & ~levels) >> wiring::kLineTx & 1) != 0;
    if (low && !line_low_) listener_.line_pulled_low(now);
    line_low_ = low;
}

void Board::drive(SignalId id, bool level, dspic::Cycle now) {
    if (id >= kPulse && id < kPulse + kPulseCount)
        emitters_[static_cast<std::size_t>(id - kPulse)].set(level, now), analog_changed();
    if (id == kCameraReset && camera_) {
        camera_->set_reset(level, now);
        listener_.edges_moved(now);
    }
    values_[id].value = level ? 1.0 : 0.0;
    listener_.signal_changed(id, values_[id].value, now);
    if (id != kAudioOn) return;
    codec_.set_released(level);
    show_speaker(now);
}

void Board::show_speaker(dspic::Cycle now) {
    if (codec_.speaker() == values_[kSpeaker].value) return;
    values_[kSpeaker].value = codec_.speaker();
    listener_.signal_changed(kSpeaker, values_[kSpeaker].value, now);
}

std::uint16_t Board::dci_exchange(const dspic::DciWord& word, dspic::Cycle now) {
    const std::uint64_t before = codec_.samples();
    const std::uint16_t got = codec_.exchange(word, values_[kLineIn].at(now));
    if (codec_.samples() != before) listener_.sound_sample(codec_.speaker(), now);
    show_speaker(now);
    return got;
}

/// Inputs stay within their ranges, whatever a state holds.
void Board::check_loaded() {
    for (SignalId id = 0; id < kSignalCount; ++id) {
        if (signals()[id].direction != cosim::SignalDirection::Input) continue;
        values_[id].value = clipped(id, values_[id].value);
        values_[id].before = clipped(id, values_[id].before);
    }
    place_levels();
    analog_changed();
}

void Board::renew_random_streams() {
    noise_ = RandomStream(parameters_.seed, parameters_.name + "/adc");
    for (std::size_t i = 0; i < microphones_.size(); ++i)
        microphones_[i].renew(parameters_.seed, parameters_.name + "/mic" + std::to_string(i));
}

void Board::settle(dspic::Cycle now) {
    for (;;) {
        const std::size_t first = motors_[1].due() < motors_[0].due() ? 1 : 0;
        const dspic::Cycle due = motors_[first].due();
        if (due > now) return;
        const std::uint64_t lost = motors_[first].lost();
        if (!motors_[first].settle(due)) {
            if (motors_[first].lost() != lost) listener_.step_lost(static_cast<int>(first), due);
            continue;
        }
        const SignalId id = first == 0 ? kWheelLeft : kWheelRight;
        values_[id].value = static_cast<double>(motors_[first].steps());
        listener_.signal_changed(id, values_[id].value, due);
    }
}

std::uint16_t Board::levels(dspic::PortLetter port, dspic::Cycle now) {
    if (camera_ && port == wiring::kCameraData)
        return static_cast<std::uint16_t>(levels_[static_cast<std::size_t>(port)] |
                                          camera_->data(now) << wiring::kFirstCameraData);
    return quiet_levels(port, now);
}

std::uint16_t Board::quiet_levels(dspic::PortLetter port, dspic::Cycle now) {
    unsigned levels = levels_[static_cast<std::size_t>(port)];
    if (!camera_) return static_cast<std::uint16_t>(levels);
    if (port == wiring::kCameraLines) {
        if (camera_->href(now)) levels |= 1u << wiring::kCameraHref;
        if (camera_->vsync(now)) levels |= 1u << wiring::kCameraVsync;
        if (camera_->pclk(now)) levels |= 1u << wiring::kCameraPclk;
    } else if (port == wiring::kCameraData) {
        levels |= static_cast<unsigned>(camera_->quiet_data(now)) << wiring::kFirstCameraData;
    }
    return static_cast<std::uint16_t>(levels);
}

dspic::Cycle Board::next_edge(dspic::PortLetter port, std::uint16_t monitored, dspic::Cycle after) const {
    dspic::Cycle next = dspic::kNoCycle;
    if (!camera_ || !camera_->running()) return next;
    const auto monitors = [&](dspic::PortLetter letter, unsigned pins) {
        return port == letter && (monitored & pins) != 0;
    };
    if (monitors(wiring::kCameraLines, 1u << wiring::kCameraHref)) next = camera_->next_href(after);
    if (monitors(wiring::kCameraLines, 1u << wiring::kCameraVsync))
        next = std::min(next, camera_->next_vsync(after));
    if (monitors(wiring::kCameraLines, 1u << wiring::kCameraPclk) ||
        monitors(wiring::kCameraData, 0xFFu << wiring::kFirstCameraData))
        next = std::min(next, camera_->next_byte(after));
    return next;
}

std::optional<cosim::I2cPhase> Board::camera_i2c(const cosim::I2cPhase& phase, dspic::Cycle written) {
    const std::optional<cosim::I2cPhase> answer = camera_->i2c(phase, written);
    if (camera_->edges_moved()) listener_.edges_moved(written);
    return answer;
}

Board::OwnPhase Board::own_i2c(const cosim::I2cPhase& phase, dspic::Cycle answered) {
    if (!camera_) return {};
    const bool stop = phase.kind == cosim::I2cPhaseKind::Stop && camera_->selected();
    const std::optional<cosim::I2cPhase> answer = camera_i2c(phase, answered);
    return {stop || answer.has_value(), answer};
}

dspic::OutsidePin Board::outside(dspic::PortLetter port, int bit) const {
    for (const PinUse& pin : wiring::kPins)
        if (pin.port == port && pin.bit == bit)
            return {pin.role == Role::Input || pin.role == Role::InputLow ||
                        (pin.role == Role::Camera && camera_.has_value()),
                    pin.function};
    return {.changes = false};
}

/// Counts of what stands at AN`channel`, before light, sound and noise.
double Board::level_at(int channel, dspic::Cycle now) const {
    if (parameters_.revision == Revision::Rev13 && channel >= kFirstAccelerationChannel) {
        if (channel == kBatteryChannel) return battery_counts(values_[kBatteryVoltage].at(now));
        if (channel < kBatteryChannel) return 0.0;
    }
    return values_[kAnalogWiring[static_cast<std::size_t>(channel)]].at(now);
}

void Board::analog_changed() {
    ++analog_epoch_;
    analog_settled_ = dspic::kNoCycle;
}

std::uint64_t Board::analog_epoch(dspic::Cycle from) {
    if (phototransistor_noise_ > 0 || parameters_.adc_noise_counts > 0 || analog_faults_.any()) return 0;
    if (analog_settled_ == dspic::kNoCycle) {
        dspic::Cycle settled = 0;
        for (const Input& input : values_)
            settled = std::max(settled, input.since);
        const auto follow = [&settled](const auto& parts) {
            for (const auto& part : parts)
                settled = std::max(settled, part.settled_from());
        };
        follow(emitters_);
        follow(lights_);
        follow(sounds_);
        analog_settled_ = settled;
    }
    if (from < analog_settled_) return 0;
    for (std::size_t i = 0; i < microphones_.size(); ++i)
        if (values_[kMicrophoneLevel + i].value > 0) return 0;  // every conversion draws another value
    return analog_epoch_;
}

double Board::analog(int channel, dspic::Cycle now) {
    double counts = level_at(channel, now);
    if (channel >= kFirstProximityChannel) {
        const int sensor = channel - kFirstProximityChannel;
        const Emitter& emitter = emitters_[static_cast<std::size_t>(sensor % kPulseCount)];
        // Mostly nothing is near, which saves working out how far the emitter's light has risen.
        const double reflected = values_[static_cast<std::size_t>(kProximity + sensor)].at(now);
        if (reflected != 0.0) counts -= reflected * emitter.intensity(now);
        counts -= lights_[static_cast<std::size_t>(sensor)].counts_at(now);
        counts *= 1.0 - ambient_saturation_[static_cast<std::size_t>(sensor)];
    }
    if (channel >= kFirstMicrophoneChannel && channel < kFirstMicrophoneChannel + kMicrophoneCount) {
        const auto i = static_cast<std::size_t>(channel - kFirstMicrophoneChannel);
        counts +=
            microphones_[i].sample(values_[kMicrophoneLevel + i].at(now), values_[kMicrophoneLost].value) +
            sounds_[i].at(now);
    }
    const double noise =
        channel >= kFirstProximityChannel ? phototransistor_noise_ : parameters_.adc_noise_counts;
    if (noise > 0) counts += noise * noise_.normal();
    const double clipped = counts > 0.0 ? counts : 0.0;
    constexpr double kWhole = 0x1.0p52;  // from here on doubles are whole: to the nearest, to even between
    const double code = clipped < kFullScale ? (clipped + kWhole) - kWhole : kFullScale;
    const double reading = (code + kInsideCode) / kSpan;
    return analog_faults_.any() ? analog_faults_.apply(channel, reading, now) : reading;
}

}  // namespace puckloop::pic
