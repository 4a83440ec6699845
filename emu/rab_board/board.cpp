#include "emu/rab_board/board.h"

#include <algorithm>

namespace puckloop::rab {

namespace {

constexpr double kFullScale = 4095.0;
constexpr double kSpan = 4096.0;
// Where inside its code a value is put, so that neither truncation nor rounding moves it to the next one.
constexpr double kInsideCode = 0.25;
constexpr double kPartsPerMillion = 1e-6;
constexpr double kDropout = 0.1;  // V, of the regulator

template <std::size_t... i>
std::array<PeakDetector, kSensorCount> detectors(const PeakDetectorParameters& parameters,
                                                 std::index_sequence<i...>) {
    return {((void)i, PeakDetector(parameters))...};
}

std::uint16_t bit(int index) {
    return static_cast<std::uint16_t>(1u << index);
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
      noise_(parameters.seed, parameters.name + "/adc"),
      potentiometer_(kPowerAtPowerOn, parameters.potentiometer_settling),
      peaks_(detectors(parameters.peak, std::make_index_sequence<kSensorCount>())) {
    for (SignalId id = 0; id < kSignalCount; ++id)
        values_[id] = signals()[id].initial;
    for (const PinUse& pin : wiring::kPins)
        if (pin.role == Role::PulledHigh || pin.role == Role::Demodulator)
            levels_[static_cast<std::size_t>(pin.port)] |= bit(pin.bit);
}

std::optional<dspic::PortLetter> Board::set_signal(SignalId id, double value, cosim::Time now) {
    if (id >= kSignalCount || signals()[id].direction != cosim::SignalDirection::Input) return std::nullopt;
    values_[id] = clipped(id, value);
    if (is_supply(id)) return std::nullopt;
    if (id >= kPeak) {
        peaks_[id - kPeak].set_input(values_[id], now);
        return std::nullopt;
    }
    for (const PinUse& pin : wiring::kPins) {
        if (pin.role != Role::Demodulator || pin.index != id - kDemodulator) continue;
        std::uint16_t& level = levels_[static_cast<std::size_t>(pin.port)];
        const std::uint16_t before = level;
        const bool carrier = values_[id] >= 0.5;
        level = static_cast<std::uint16_t>(carrier ? level & ~bit(pin.bit) : level | bit(pin.bit));
        if (level != before) return pin.port;
    }
    return std::nullopt;
}

double Board::supply() const {
    const double battery = profile_.value_or(values_[kBattery]) - sag_;
    return std::max(0.0, std::min({kRegulatedVolts, values_[kVdd], battery - kDropout}));
}

void Board::settle(cosim::Time now) {
    while (potentiometer_.due() <= now) {
        const cosim::Time due = potentiometer_.due();
        report(kPower, potentiometer_.settle(), due);
    }
}

void Board::report(SignalId id, double value, cosim::Time now) {
    if (values_[id] == value) return;
    values_[id] = value;
    listener_.signal_changed(id, value, now);
}

void Board::driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven, dspic::Cycle now) {
    const cosim::Time time = time_of(now);
    settle(time);
    const auto index = static_cast<std::size_t>(port);
    const auto high = static_cast<std::uint16_t>(levels & driven);
    const auto low = static_cast<std::uint16_t>(~levels & driven);
    const unsigned changed = (outputs_[index] ^ high) | (low_[index] ^ low);
    outputs_[index] = high;
    low_[index] = low;
    if (changed == 0) return;
    for (const PinUse& pin : wiring::kPins) {
        if (pin.port != port || (changed & bit(pin.bit)) == 0) continue;
        // A pin that is an input drives nothing; the select line rests high, all others rest low.
        const bool level =
            pin.role == Role::ChipSelect ? (low & bit(pin.bit)) == 0 : (high & bit(pin.bit)) != 0;
        drive(pin, level, time);
    }
    light(time);
}

void Board::drive(const PinUse& pin, bool high, cosim::Time now) {
    switch (pin.role) {
    case Role::Gate:
        gates_ = static_cast<std::uint16_t>(high ? gates_ | bit(pin.index) : gates_ & ~bit(pin.index));
        break;
    case Role::Supply:
        emitter_supply_ = high;
        break;
    case Role::PeakReset:
        if (peaks_[pin.index].resetting() != high) peaks_[pin.index].set_reset(high, now);
        report(static_cast<SignalId>(kPeakReset + pin.index), high ? 1 : 0, now);
        break;
    case Role::ChipSelect:
        potentiometer_.select(high, now);
        break;
    case Role::Led:
        report(kLed, high ? 1 : 0, now);
        break;
    case Role::Demodulator:
    case Role::PulledHigh:
    case Role::Open:
        break;
    }
}

/// Carrier reaches the emitters whose gate is on, while there is supply and carrier.
void Board::light(cosim::Time now) {
    const std::uint16_t before = emitters_;
    emitters_ = emitter_supply_ && values_[kCarrier] > 0 ? gates_ : 0;
    if (emitters_ == before) return;
    listener_.emitters_changed(emitters_, now);
    for (int i = 0; i < kSensorCount; ++i)
        report(static_cast<SignalId>(kEmitter + i), (emitters_ & bit(i)) != 0 ? 1 : 0, now);
}

std::uint16_t Board::levels(dspic::PortLetter port, dspic::Cycle /*now*/) {
    return levels_[static_cast<std::size_t>(port)];
}

double Board::analog(int channel, dspic::Cycle now) {
    if (channel < kFirstPeakChannel || channel >= kFirstPeakChannel + kSensorCount) return 0.0;
    double counts = peaks_[static_cast<std::size_t>(channel - kFirstPeakChannel)].level(time_of(now));
    if (parameters_.adc_noise_counts > 0) counts += parameters_.adc_noise_counts * noise_.normal();
    const double clipped = counts > 0.0 ? counts : 0.0;
    constexpr double kWhole = 0x1.0p52;  // from here on doubles are whole: to the nearest, to even between
    const double code = clipped < kFullScale ? (clipped + kWhole) - kWhole : kFullScale;
    const double reading = (code + kInsideCode) / kSpan;
    return analog_faults_.any() ? analog_faults_.apply(channel, reading, now) : reading;
}

void Board::i2c_slave_answer(int unit, const cosim::I2cPhase& answer) {
    if (unit == kI2cUnit) listener_.i2c_answer(answer, dspic::i2c_answer_time(answer));
}

std::uint16_t Board::spi_exchange(int unit, std::uint16_t sent, int bits, dspic::Cycle /*now*/) {
    if (unit == kPotentiometerUnit) potentiometer_.shift(sent, bits);
    return 0;
}

void Board::output_compare_changed(int unit, dspic::Cycle now) {
    if (unit != kCarrierUnit || chip_ == nullptr) return;
    const cosim::Time time = time_of(now);
    settle(time);
    const dspic::OutputCompareState state = chip_->output_compare(unit);
    const cosim::ClockDomain& clock = chip_->clock();
    const bool on = state.running && state.high > 0 && state.high < state.period;
    const double hertz = clock.hertz() * (1 + clock.ppm() * kPartsPerMillion);
    report(kCarrier, on ? hertz / static_cast<double>(state.period) : 0.0, time);
    light(time);
}

}  // namespace puckloop::rab
