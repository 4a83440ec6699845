#pragma once
// The TAM's main board and its two side boards around the ATmega1284P: what is at each pin, the LED driver on
// the two-wire bus, the light barriers, the battery. Wiring: pin_table.h. Signals: signals.h.
// Source: TAM fact sheet, sections 2, 4 and 5.
//
// Deviations:
// 1. Which infra-red LED faces which sensor is not in the sheet: the left one faces the front sensor, the
//    right one the back sensor. The firmware switches both together.
// 2. ADC noise is white, Gaussian and the same on every channel.
// 3. The supply is gone 1 ms after the firmware sets PWR_CLEAR, at once and for good.
// 4. The bus has no other device; SCL is never stretched.
// 5. The converter (LTC3536, which raises as well as lowers) makes 3.3 V of any battery from 1.8 V on, and
//    nothing below; its own figures for that are within 0.1 V. The on/off switch stays on meanwhile.

#include "base/random.h"
#include "base/states/archive.h"
#include "emu/avr/chip/chip.h"
#include "emu/avr/peripherals/pins.h"
#include "emu/chip/faults/ambient_shares.h"
#include "emu/chip/faults/analog_faults.h"
#include "emu/tam_avr/led_driver.h"
#include "emu/tam_avr/light_barrier.h"
#include "emu/tam_avr/pin_table.h"
#include "emu/tam_avr/signals.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>

namespace puckloop::tam {

/// What differs from one booth to the next.
struct BoardParameters {
    std::string name = "tam";  ///< the random stream is "<name>/adc"
    std::uint64_t seed = 1;    ///< the run's seed
    double resonator_hertz = kResonatorHertz;
    double resonator_ppm = 0.0;     ///< its error, + is fast; ceramic resonators are within 5000
    double adc_noise_counts = 0.5;  ///< standard deviation, of 1024 counts, 0 or more
    LightBarrierParameters barrier{};
};

/// What leaves the board, in time order.
class BoardListener {
  public:
    virtual ~BoardListener() = default;
    /// An output signal changed.
    virtual void signal_changed(SignalId id, double value, cosim::Time now) = 0;
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// A port's drivers changed; for logs.
    virtual void pins_driven(avr::PortLetter, std::uint8_t /*levels*/, std::uint8_t /*driven*/,
                             cosim::Time /*now*/) {}
    /// A phase of the two-wire bus with what it was answered (cosim/core/message.h), when it begins; for
    /// logs.
    virtual void twi_phase(const cosim::I2cPhase&) {}
};

/// Use: construct, load(), then run_until() in rising steps, handing in what arrives in between.
class Board : private avr::Pins {
  public:
    Board(const BoardParameters& parameters, BoardListener& listener);

    /// Firmware, and power on. The image was checked against the chip. Fuses as the project's boards have
    /// them (TAM fact sheet, section 1), except BOOTRST, which is programmed only if the image has a boot
    /// loader; an image's own fuses win.
    void load(const image::AvrImage& image);
    /// Runs everything that starts before `until`; early only at one of the chip's stop addresses. Without
    /// supply nothing happens.
    void run_until(cosim::Time until);
    /// How far the board has been run.
    cosim::Time now() const { return now_; }

    /// Sets an input signal from now on, clipped to its range. Outputs cannot be set; asking for it is
    /// ignored.
    void set_signal(SignalId id, double value);
    double signal(SignalId id) const { return values_[id]; }
    void uart_receive(int unit, const cosim::UartFrame& frame);
    /// Unless something comes in, no output changes before this time; kNever once the board is off.
    cosim::Time wakes() const { return powered() ? std::min(chip_.wakes(), off_at_) : cosim::kNever; }
    /// The reset button, or DTR of the console's cable: a pulse now.
    void reset_button();
    /// The same for a debugger, who sees the chip as it is then. `inside`: before an instruction
    /// (chip::Instrument), at its time.
    void reset_now(bool inside);

    /// The firmware has not switched the board off.
    bool powered() const { return !off_; }
    /// VCC, in volts.
    double supply() const;
    avr::Chip& chip() { return chip_; }
    const avr::Chip& chip() const { return chip_; }
    const LedDriver& leds() const { return leds_; }

    chip::AnalogFaults& analog_faults() { return analog_faults_; }
    /// The battery's voltage is lower by so much.
    void set_sag(double volts);
    /// It has this voltage, before any sag, whatever set_signal() sets; nullopt: what that sets.
    void set_battery(std::optional<double> volts);
    /// Light on each barrier's sensor, as a share of the supply.
    void set_ambient(const chip::AmbientShares& shares);

    /// Everything that time changes; the parameters are each board's own. Throws StateError.
    template <class Archive>
    void state(Archive& archive) {
        constexpr double kHighestSignal = 5.0;
        archive(noise_, leds_, barriers_, addressed_, analog_faults_);
        archive.bounded(sag_, 0.0, 1e3);
        archive.bounded(battery_, -1e15, 1e15);
        archive(profile_, off_);
        for (double& value : values_)
            archive.bounded(value, 0.0, kHighestSignal);
        archive.bounded(now_, 0, cosim::kNever);
        archive.bounded(off_at_, 0, cosim::kNever);
        archive.part("chip", chip_);
        archive.check(now_ == chip_.now() || !powered(), "board and chip at different times");
    }
    /// Goes with a checkpoint of state(), see avr::Chip::mark().
    void mark() { chip_.mark(); }
    void rewind() { chip_.rewind(); }
    void settle() { chip_.settle(); }
    /// Noise begins anew, by this board's own name and seed.
    void renew_random_streams() { noise_ = RandomStream(parameters_.seed, parameters_.name + "/adc"); }

  private:
    void driven(avr::PortLetter port, std::uint8_t levels, std::uint8_t driven, avr::Cycle now) override;
    std::uint8_t levels(avr::PortLetter port, std::uint8_t pull_ups, avr::Cycle now) override;
    double analog(int channel, avr::Cycle now) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override { listener_.uart_sent(unit, frame); }
    void twi_phase(const cosim::I2cPhase& phase) override;

    cosim::Time time_of(avr::Cycle cycle) const { return chip_.clock().time_of(cycle); }
    void update_leds(cosim::Time now);
    void report(SignalId id, double value, cosim::Time now);
    void switch_off(cosim::Time now);
    void update_supply();

    BoardParameters parameters_;
    BoardListener& listener_;
    RandomStream noise_;
    LedDriver leds_;
    std::array<LightBarrier, kBarriers> barriers_;
    std::array<double, kSignalCount> values_{};
    bool addressed_ = false;  ///< the LED driver acknowledged its address
    cosim::Time now_ = 0;
    chip::AnalogFaults analog_faults_;
    double sag_ = 0.0, battery_ = 0.0;    ///< volts; the battery's without the sag
    std::optional<double> profile_;       ///< in place of the battery's
    cosim::Time off_at_ = cosim::kNever;  ///< when the supply goes
    bool off_ = false;                    ///< by the firmware, for good
    avr::Chip chip_;                      ///< last: it looks at the rest when it is made
};

}  // namespace puckloop::tam
