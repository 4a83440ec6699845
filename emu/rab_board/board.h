#pragma once
// The range-and-bearing board (e-RandB) around its dsPIC33FJ256GP710: what stands at each pin, and what the
// firmware's pins do to the air. Wiring: pin_table.h. Signals: signals.h.
// Source: range-and-bearing fact sheet 1.4, 4.1, 5.2, 5.3.
//
// Deviations:
// 1. An emitter is on or off: no rise time of its own (the medium's demodulator delays stand for all of it).
// 2. ADC noise is white, Gaussian and the same on every channel.
// 3. The emitters' supply needs no time to rise when RF12 switches it on.
// 4. VDD is 3.3 V, less where the battery, with 0.1 V of dropout, cannot hold them (an assumption: no
// schematic
//    was at hand). The potentiometer, detectors and inputs do not notice; a reading stays a share of VDD.

#include "base/random.h"
#include "emu/board/can_ports.h"
#include "emu/chip/faults/analog_faults.h"
#include "emu/dspic/chip/chip.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/rab_board/arriving_light.h"
#include "emu/rab_board/peak_detector.h"
#include "emu/rab_board/pin_table.h"
#include "emu/rab_board/potentiometer.h"
#include "emu/rab_board/signals.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace puckloop::rab {

inline constexpr double kRegulatedVolts = 3.3;

/// What differs from one board to the next.
struct BoardParameters {
    std::string name = "rab";  ///< the random stream is "<name>/adc"
    std::uint64_t seed = 1;    ///< the run's seed
    double crystal_hertz = kCrystalHertz;
    double crystal_ppm = 0.0;       ///< error of the crystal, + is fast
    double adc_noise_counts = 1.0;  ///< standard deviation, 0 or more
    PeakDetectorParameters peak{};
    board::CanModules can = 0;  ///< that are on a bus
    cosim::Time potentiometer_settling = kPotentiometerSettling;
};

/// What leaves the board, in time order.
class BoardListener {
  public:
    virtual ~BoardListener() = default;
    /// An output signal changed.
    virtual void signal_changed(SignalId id, double value, cosim::Time now) = 0;
    /// The same for all emitters at once: bit 0 is emitter 1.
    virtual void emitters_changed(std::uint16_t on, cosim::Time now) = 0;
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// The board, as slave, answers the phase that its chip was given.
    virtual void i2c_answer(const cosim::I2cPhase& answer, cosim::Time now) = 0;
    /// The firmware made the chip master of the bus (no known firmware does).
    virtual void i2c_phase(int unit, const cosim::I2cPhase& phase) = 0;
    /// For the bus of a module among BoardParameters::can.
    virtual void can_to_bus(int /*unit*/, const cosim::CanMessage& /*message*/) {}
};

class Board : public dspic::Pins {
  public:
    Board(const BoardParameters& parameters, BoardListener& listener);
    /// The chip at whose pins the board stands; before it runs.
    void connect(const dspic::Chip& chip) { chip_ = &chip; }

    /// Sets an input signal from `now` on, clipped to its range. Returns the port whose pins changed, if any:
    /// the chip must hear of it. Outputs cannot be set; asking for it is ignored.
    std::optional<dspic::PortLetter> set_signal(SignalId id, double value, cosim::Time now);
    /// The same for a demodulator or a peak detector, ahead of time: it shows where somebody looks. Before
    /// settle() has passed it nothing but more light may be set.
    void light_arrives(SignalId id, double value, cosim::Time time) { arriving_.add({time, id, value}); }
    static bool is_light(SignalId id) { return id < kEmitter; }
    static constexpr dspic::PortLetter kDemodulators = dspic::PortLetter::D;
    /// Registers of the chip by which its program looks at light, or moves a peak detector's reset, and
    /// control registers of modules that could take a reset's pin over.
    static std::span<const std::string_view> looks_at_light();
    static std::span<const std::string_view> other_modules();
    /// All of it that arrives at or before `now`.
    void show_light(cosim::Time now);
    /// The battery's voltage is lower by so much. The chip must hear of it (Chip::supply_changed()), as of
    /// signals that change the supply.
    void set_sag(double volts) { sag_ = volts; }
    /// It has this voltage, before any sag, whatever set_signal() sets; nullopt: what that sets.
    void set_battery(std::optional<double> volts) { profile_ = volts; }
    double supply() const override;
    static bool is_supply(SignalId id) { return id == kBattery || id == kVdd; }
    /// Present value of any signal.
    double signal(SignalId id) const { return values_[id]; }
    /// Emitters that are on: bit 0 is emitter 1.
    std::uint16_t emitters() const { return emitters_; }
    const Potentiometer& potentiometer() const { return potentiometer_; }

    /// Reports what the board did by itself at or before `now`, and shows the light of until then. To be
    /// called before time is said to have passed `now`.
    void settle(cosim::Time now);

    chip::AnalogFaults& analog_faults() { return analog_faults_; }

    /// Signals, detectors, potentiometer, pins and noise; the parameters are each board's own.
    template <class Archive>
    void state(Archive& archive) {
        archive(noise_, potentiometer_, peaks_, low_, outputs_, levels_, gates_, emitters_, emitter_supply_,
                analog_faults_, profile_);
        archive.bounded(sag_, 0.0, 1e3);
        if constexpr (Archive::kLoads) arriving_ = {};
        for (double& value : values_)
            archive.bounded(value, -1e15, 1e15);
    }
    /// Noise begins anew, by this board's own name and seed.
    void renew_random_streams() { noise_ = RandomStream(parameters_.seed, parameters_.name + "/adc"); }

    // dspic::Pins
    void driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven,
                dspic::Cycle now) override;
    std::uint16_t levels(dspic::PortLetter port, dspic::Cycle now) override;
    std::uint16_t quiet_levels(dspic::PortLetter port, dspic::Cycle now) override;
    dspic::Cycle next_edge(dspic::PortLetter port, std::uint16_t monitored,
                           dspic::Cycle after) const override;
    double analog(int channel, dspic::Cycle now) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override { listener_.uart_sent(unit, frame); }
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override { listener_.i2c_phase(unit, phase); }
    bool can_wired(int unit) const override { return parameters_.can >> (unit - 1) & 1; }
    void can_to_bus(int unit, const cosim::CanMessage& message, dspic::Cycle) override {
        listener_.can_to_bus(unit, message);
    }
    void i2c_slave_answer(int unit, const cosim::I2cPhase& answer) override;
    std::uint16_t spi_exchange(int unit, std::uint16_t sent, int bits, dspic::Cycle now) override;
    void output_compare_changed(int unit, dspic::Cycle now) override;
    bool wants_pwm_edges(int) const override { return false; }

    static constexpr int kPorts = 7;

  private:
    cosim::Time time_of(dspic::Cycle now) const { return chip_ != nullptr ? chip_->clock().time_of(now) : 0; }
    void drive(const PinUse& pin, bool high, cosim::Time now);
    void light(cosim::Time now);
    void settle_potentiometer(cosim::Time now);
    void show(SignalId id, double value, cosim::Time now);
    void report(SignalId id, double value, cosim::Time now);

    BoardParameters parameters_;
    BoardListener& listener_;
    const dspic::Chip* chip_ = nullptr;
    RandomStream noise_;
    Potentiometer potentiometer_;
    std::array<PeakDetector, kSensorCount> peaks_;
    std::array<double, kSignalCount> values_{};
    std::array<std::uint16_t, kPorts> low_{};      ///< pins driven low
    std::array<std::uint16_t, kPorts> outputs_{};  ///< pins driven high
    std::array<std::uint16_t, kPorts> levels_{};   ///< what the board puts on the pins
    std::uint16_t gates_ = 0;
    std::uint16_t emitters_ = 0;
    bool emitter_supply_ = false;
    ArrivingLight arriving_;  ///< none between two runs of the chip
    chip::AnalogFaults analog_faults_;
    double sag_ = 0.0;               ///< V
    std::optional<double> profile_;  ///< in place of the battery's
};

}  // namespace puckloop::rab
