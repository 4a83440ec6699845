#pragma once
// The e-puck main board around its dsPIC30F6014A: what stands at each pin, and what the firmware's pins do to
// the world. Wiring: pin_table.h. Signals: signals.h.
// Source: e-puck fact sheet 3.2 (pins), 3.5 (motors), 5.1, 5.4 to 5.6 (analog values).
//
// Deviations:
// 1. A sensor sees the light of its own pulse line only: no crosstalk from the neighbours (at most 2 % of
// it).
// 2. ADC noise is white and Gaussian, the same on every channel but for the phototransistors', which may have
//    their own; motors and supply add none.
// 3. The microphones and the accelerometer have no bandwidth of their own.

#include "base/random.h"
#include "emu/board/can_ports.h"
#include "emu/camera/camera.h"
#include "emu/chip/faults/ambient_shares.h"
#include "emu/chip/faults/analog_faults.h"
#include "emu/dspic/devices/errata.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/pic/board_revision.h"
#include "emu/pic/emitter.h"
#include "emu/pic/light_input.h"
#include "emu/pic/microphone.h"
#include "emu/pic/si3000.h"
#include "emu/pic/signals.h"
#include "emu/pic/sound_input.h"
#include "emu/pic/stepper.h"

#include <array>
#include <cstdint>
#include <optional>
#include <string>

namespace puckloop::pic {

/// Standard deviation at a phototransistor within a few milliseconds, counts. IRcom's receiver takes a range
/// of 10 counts in 32 scans of any of eight sensors for light that is switched (e-puck fact sheet, 3.10).
/// White noise of 2 counts does that in four windows of five, of 1.25 in one of 400; robots do hear each
/// other over 22 cm, where that table ends. 1 is also the least of the sheet's 1 to 3 LSB (section 5).
inline constexpr double kPhototransistorNoise = 1.0;

/// What differs from one robot to the next. All of it may be set by a scenario.
struct BoardParameters {
    std::string name = "epuck";  ///< random streams are "<name>/adc", "<name>/mic0", ...
    std::uint64_t seed = 1;      ///< the run's seed
    double crystal_hertz =
        7'372'800.0;                ///< FCY is twice this (XT with PLL x8), whatever the image's FOSC states
    double crystal_ppm = 0.0;       ///< error of the crystal, + is fast
    double adc_noise_counts = 1.0;  ///< standard deviation, 0 or more
    std::optional<double> phototransistor_noise_counts{};  ///< of AN8..AN15; none: as of all channels
    double light_time_constant_s = 20e-6;                  ///< of emitter and phototransistor together, > 0
    double coil_settle_s = 2e-6;     ///< for how long a coil pattern must stand to be a step
    double battery_low_volts = 3.4;  ///< below this RF1 falls
    int selector = 0;                ///< initial position, 0..15
    Revision revision = Revision::Rev12;
    dspic::Errata errata{};     ///< of the chip
    board::CanModules can = 0;  ///< that are on a bus
};

/// What leaves the board.
class BoardListener {
  public:
    virtual ~BoardListener() = default;
    /// An output signal changed.
    virtual void signal_changed(SignalId id, double value, dspic::Cycle now) = 0;
    virtual void uart_sent(int unit, const cosim::UartFrame& frame) = 0;
    /// The codec turned a sample into sound; `value` is that of the signal `speaker`.
    virtual void sound_sample(double /*value*/, dspic::Cycle /*now*/) {}
    virtual void i2c_phase(int unit, const cosim::I2cPhase& phase) = 0;
    /// The chip answers as a slave, `now` on the wires.
    virtual void i2c_answer(const cosim::I2cPhase& /*answer*/, cosim::Time /*now*/) {}
    /// For the bus of a module among BoardParameters::can.
    virtual void can_to_bus(int /*unit*/, const cosim::CanMessage& /*message*/) {}
    /// Edges that the board makes by itself moved, from cycle `at` on (Chip::edges_moved()).
    virtual void edges_moved(dspic::Cycle /*at*/) {}
    /// A fault kept motor 0 (left) or 1 from making a step that was due at `now`.
    virtual void step_lost(int /*motor*/, dspic::Cycle /*now*/) {}
    /// The firmware pulls UART1's TX low by the port pin: a break, if the UART is off.
    virtual void line_pulled_low(dspic::Cycle /*now*/) {}
};

class Board : public dspic::Pins {
  public:
    Board(const BoardParameters& parameters, BoardListener& listener);

    /// Sets an input signal from `now` on, clipped to its range. Returns the port whose pins changed, if any:
    /// the chip must hear of it. Outputs cannot be set; asking for it is ignored.
    std::optional<dspic::PortLetter> set_signal(SignalId id, double value, dspic::Cycle now);
    /// Present value of any signal.
    double signal(SignalId id) const;

    /// Reports every motor step that was due at or before `now`. To be called before time is said to have
    /// passed `now`.
    void settle(dspic::Cycle now);

    /// Puts a camera on the board, before its chip runs; `scenery` outlives it.
    void fit_camera(const camera::Fitting& fitting, camera::Scenery& scenery) {
        camera_.emplace(fitting, scenery);
    }
    camera::Camera* camera() { return camera_ ? &*camera_ : nullptr; }
    const camera::Camera* camera() const { return camera_ ? &*camera_ : nullptr; }
    /// A phase for the camera, as a device of the bus. Returns its answer, nothing if it is not addressed or
    /// none is due. `written`: from which cycle on a register that is written counts.
    std::optional<cosim::I2cPhase> camera_i2c(const cosim::I2cPhase& phase, dspic::Cycle written);
    /// Where nobody else is on the bus: what becomes of a phase of the chip, its master.
    struct OwnPhase {
        bool ours = false;  ///< nobody else need hear of it
        std::optional<cosim::I2cPhase> answer{};
    };
    /// `answered`: the cycle in which an answer is complete.
    OwnPhase own_i2c(const cosim::I2cPhase& phase, dspic::Cycle answered);

    // Faults.
    chip::AnalogFaults& analog_faults() { return analog_faults_; }
    /// The battery's voltage is lower by so much from `now` on. Returns as set_signal() does.
    std::optional<dspic::PortLetter> set_sag(double volts, dspic::Cycle now);
    /// It has this voltage, before any sag, whatever set_signal() sets; nullopt: what that sets.
    std::optional<dspic::PortLetter> set_battery(std::optional<double> volts, dspic::Cycle now);
    /// Light that swallows this share of each proximity sensor's signal.
    void set_ambient(const chip::AmbientShares& shares) {
        ambient_saturation_ = shares;
        ++analog_epoch_;
    }
    /// The wheel of motor 0 (left) or 1 does not turn from `now` on.
    void set_held(int motor, bool held, dspic::Cycle now);

    /// VDD: the regulator's 3.3 V, less where the battery cannot hold them.
    double supply() const override;
    const Si3000& codec() const { return codec_; }

    /// Positions of all signals, lights, motors and noise; the parameters are each board's own.
    template <class Archive>
    void state(Archive& archive) {
        archive(noise_, values_, emitters_, lights_, microphones_, motors_, outputs_, line_low_,
                analog_faults_, codec_, sounds_);
        archive.bounded(sag_, 0.0, 1e3);
        archive.bounded(battery_, -1e15, 1e15);
        archive(profile_);
        for (double& share : ambient_saturation_)
            archive.bounded(share, 0.0, 1.0);
        if (camera_) archive(*camera_);
        if constexpr (Archive::kLoads) check_loaded();
    }
    /// Noise begins anew, by this board's own name and seed.
    void renew_random_streams();

    const StepperDecoder& left_motor() const { return motors_[0]; }
    const StepperDecoder& right_motor() const { return motors_[1]; }

    // dspic::Pins
    void driven(dspic::PortLetter port, std::uint16_t levels, std::uint16_t driven,
                dspic::Cycle now) override;
    std::uint16_t levels(dspic::PortLetter port, dspic::Cycle now) override;
    std::uint16_t quiet_levels(dspic::PortLetter port, dspic::Cycle now) override;
    dspic::Cycle next_edge(dspic::PortLetter port, std::uint16_t monitored,
                           dspic::Cycle after) const override;
    double analog(int channel, dspic::Cycle now) override;
    std::uint64_t analog_epoch(dspic::Cycle from) override;
    void uart_sent(int unit, const cosim::UartFrame& frame) override { listener_.uart_sent(unit, frame); }
    void i2c_phase(int unit, const cosim::I2cPhase& phase) override { listener_.i2c_phase(unit, phase); }
    void i2c_slave_answer(int, const cosim::I2cPhase& answer) override {
        listener_.i2c_answer(answer, dspic::i2c_answer_time(answer));
    }
    bool can_wired(int unit) const override { return parameters_.can >> (unit - 1) & 1; }
    void can_to_bus(int unit, const cosim::CanMessage& message, dspic::Cycle) override {
        listener_.can_to_bus(unit, message);
    }
    std::uint16_t dci_exchange(const dspic::DciWord& word, dspic::Cycle now) override;

    dspic::OutsidePin outside(dspic::PortLetter port, int bit) const override;

    static constexpr int kPorts = 7;

  private:
    /// An input and what it was before its last change: the ADC may ask a few cycles late.
    struct Input {
        double value = 0.0;
        double before = 0.0;
        dspic::Cycle since = 0;
        double at(dspic::Cycle now) const { return now < since ? before : value; }
        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(value, -1e15, 1e15);
            archive.bounded(before, -1e15, 1e15);
            archive(since);
        }
    };
    void check_loaded();
    void place_levels();
    void watch_line(std::uint16_t levels, std::uint16_t driven, dspic::Cycle now);
    void drive(SignalId id, bool level, dspic::Cycle now);
    void show_speaker(dspic::Cycle now);
    void analog_changed();
    double level_at(int channel, dspic::Cycle now) const;

    BoardParameters parameters_;
    BoardListener& listener_;
    double phototransistor_noise_;  // counts
    RandomStream noise_;
    std::array<Input, kSignalCount> values_{};
    std::array<Emitter, kPulseCount> emitters_;
    std::array<LightInput, kProximityCount> lights_;
    std::array<Microphone, kMicrophoneCount> microphones_;
    std::array<SoundInput, kMicrophoneCount> sounds_;
    std::array<StepperDecoder, 2> motors_;
    Si3000 codec_;
    std::array<std::uint16_t, kPorts> outputs_{};  ///< pins that are driven high
    bool line_low_ = false;                        ///< UART1's TX, by the port's driver
    std::array<std::uint16_t, kPorts> levels_{};   ///< what the board puts on the pins
    chip::AnalogFaults analog_faults_;
    double sag_ = 0.0, battery_ = 0.0;  ///< volts; the battery's without the sag
    std::optional<double> profile_;     ///< in place of the battery's
    chip::AmbientShares ambient_saturation_{};
    std::uint64_t analog_epoch_ = 1;
    dspic::Cycle analog_settled_ = dspic::kNoCycle;  ///< since when inputs stand still; kNoCycle: not known
    std::optional<camera::Camera> camera_;
};

}  // namespace puckloop::pic
