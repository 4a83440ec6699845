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

constexpr std::uint16_t bit(int index) {
    return static_cast<std::uint16_t>(1u << index);
}

// All demodulators are at one port, the first at this pin.
constexpr auto kDemodulatorPort = static_cast<std::size_t>(Board::kDemodulators);
constexpr int kFirstDemodulatorPin = 4;
static_assert(std::all_of(wiring::kPins.begin(), wiring::kPins.end(), [](const PinUse& pin) {
    return pin.role != Role::Demodulator || (static_cast<std::size_t>(pin.port) == kDemodulatorPort &&
                                             pin.bit == kFirstDemodulatorPin + pin.index);
}));
constexpr double kCarrierSeen = 0.5;

/// A demodulator that sees carrier pulls its pin low.
std::uint16_t with_carrier(std::uint16_t levels, int demodulator, bool carrier) {
    const std::uint16_t pin = bit(kFirstDemodulatorPin + demodulator);
    return static_cast<std::uint16_t>(carrier ? levels & ~pin : levels | pin);
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
    if (is_supply(id)) {
        values_[id] = clipped(id, value);
        return std::nullopt;
    }
    const std::uint16_t before = levels_[kDemodulatorPort];
    show(id, value, now);
    if (levels_[kDemodulatorPort] == before) return std::nullopt;
    return kDemodulators;
}

/// Light at a detector or a demodulator, from `now` on.
void Board::show(SignalId id, double value, cosim::Time now) {
    values_[id] = clipped(id, value);
    if (id >= kPeak)
        peaks_[id - kPeak].set_input(values_[id], now);
    else
        levels_[kDemodulatorPort] =
            with_carrier(levels_[kDemodulatorPort], id - kDemodulator, values_[id] >= kCarrierSeen);
}

std::span<const std::string_view> Board::looks_at_light() {
    // Demodulators, and who would look for their edges; then the resets' ports.
    static constexpr std::string_view kNames[] = {
        "CNEN1",  "CNEN2", "IC1CON", "IC2CON", "IC3CON", "IC4CON", "IC5CON", "IC6CON", "IC7CON", "IC8CON",
        "U1MODE", "U1STA", "PMD1",   "PMD2",   "PMD3",   "PORTD",  "PORTA",  "LATA",   "TRISA",  "ODCA",
        "PORTF",  "LATF",  "TRISF",  "ODCF",   "PORTG",  "LATG",   "TRISG",  "ODCG"};
    return kNames;
}

std::span<const std::string_view> Board::other_modules() {
    static constexpr std::string_view kNames[] = {"C1CTRL1", "C2CTRL1", "DCICON1"};
    return kNames;
}

void Board::show_light(cosim::Time now) {
    arriving_.take(
        now, [this](const ArrivingLight::Change& change) { show(change.id, change.value, change.time); });
}

double Board::supply() const {
    const double battery = profile_.value_or(values_[kBattery]) - sag_;
    return std::max(0.0, std::min({kRegulatedVolts, values_[kVdd], battery - kDropout}));
}

void Board::settle(cosim::Time now) {
    show_light(now);
    settle_potentiometer(now);
}

void Board::settle_potentiometer(cosim::Time now) {
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
    // What an instruction drives counts from the cycle behind it on, and light before that was there first.
    if (!arriving_.none() && now > 0) show_light(time_of(now - 1));
    settle_potentiometer(time);
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

std::uint16_t Board::levels(dspic::PortLetter port, dspic::Cycle now) {
    if (!arriving_.none()) show_light(time_of(now));
    return levels_[static_cast<std::size_t>(port)];
}

std::uint16_t Board::quiet_levels(dspic::PortLetter port, dspic::Cycle now) {
    std::uint16_t levels = levels_[static_cast<std::size_t>(port)];
    if (static_cast<std::size_t>(port) == kDemodulatorPort && !arriving_.none())
        arriving_.look(time_of(now), [&levels](const ArrivingLight::Change& change) {
            if (change.id < kPeak)
                levels = with_carrier(levels, change.id - kDemodulator, change.value >= kCarrierSeen);
        });
    return levels;
}

dspic::Cycle Board::next_edge(dspic::PortLetter port, std::uint16_t, dspic::Cycle after) const {
    if (static_cast<std::size_t>(port) != kDemodulatorPort || arriving_.none()) return dspic::kNoCycle;
    const cosim::Time next = arriving_.next_pin(time_of(after));
    return next == cosim::kNever ? dspic::kNoCycle : chip_->clock().first_cycle_at(next);
}

double Board::analog(int channel, dspic::Cycle now) {
    if (channel < kFirstPeakChannel || channel >= kFirstPeakChannel + kSensorCount) return 0.0;
    if (!arriving_.none()) show_light(time_of(now));
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
    settle_potentiometer(time);
    const dspic::OutputCompareState state = chip_->output_compare(unit);
    const cosim::ClockDomain& clock = chip_->clock();
    const bool on = state.running && state.high > 0 && state.high < state.period;
    const double hertz = clock.hertz() * (1 + clock.ppm() * kPartsPerMillion);
    report(kCarrier, on ? hertz / static_cast<double>(state.period) : 0.0, time);
    light(time);
}

}  // namespace puckloop::rab
