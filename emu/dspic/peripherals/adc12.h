#pragma once
// The 12-bit A/D converter: 16 inputs, scan, alternating multiplexers, automatic sampling and conversion,
// 16 buffers. Source: dsPIC30F Family Reference Manual, section 18; fact sheet peripherals.md section 3.
//
// Deviations
//  1. The internal RC clock (ADRC = 1) has TAD = 900 ns exactly.
//  2. No settling time after ADON, no acquisition error, no noise: the input is taken at the end of
//     sampling.
//  3. Selections of the input (ADCHS, ADCSSL) count at the start of sampling.
//  4. Reserved SSRC codes never end sampling.

#include "cosim/core/clock.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <cstdint>

namespace puckloop::dspic {

/// An automatic group of conversions has one event, its interrupt. What lies before is made up for by
/// catch_up(), in order and with its true times, before anything can see the difference: a read or write
/// of a register, a change of the pins by the chip, or the end of the chip's grant, after which the outside
/// may change.
class Adc12 {
  public:
    enum class Trigger : std::uint8_t { Software = 0, Int0 = 1, Timer3 = 2, Counter = 7 };

    static constexpr std::uint16_t kControl = 0x2A0;  ///< ADCON1
    static constexpr std::uint16_t kFirst = 0x280;    ///< ADCBUF0 ...
    static constexpr int kWords = 20;                 ///< ... to ADCHS

    Adc12(const Surroundings& around, const cosim::ClockDomain& clock, Pins& pins);

    void reset();
    /// INT0 edge or Timer3 match at cycle `at`: ends sampling if SSRC selects it.
    void trigger(Trigger source, Cycle at);
    /// Sleep without the internal RC clock, or Idle with ADSIDL set: what is in progress is lost; automatic
    /// sampling goes on afterwards.
    void hold(bool on);
    bool runs_in_sleep() const;
    /// Takes all samples and finishes all conversions due by cycle `now`.
    void catch_up(Cycle now);

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
        if constexpr (Archive::kLoads) {
            forget_quiet();
            group_.epoch = 0;
        }
        constexpr HalfCycle kMostBehind = 4000;
        archive.check(!state_.timed || state_.phase_end >= 2 * around_.now ||
                          2 * around_.now - state_.phase_end <= kMostBehind,
                      "a conversion long overdue");
    }

  private:
    enum class Phase : std::uint8_t { Off, Idle, Sampling, Converting };
    /// Times are in half instruction cycles, the unit of TAD.
    using HalfCycle = std::uint64_t;
    struct State {
        Phase phase = Phase::Off;
        HalfCycle phase_end = 0;  ///< of a conversion, or of sampling when the internal counter ends it
        bool held = false;
        bool timed = false;        ///< phase_end is set
        bool mux_b = false;        ///< the input being sampled belongs to MUX B
        std::uint8_t channel = 0;  ///< being sampled or converted
        std::uint8_t scanned = 0;  ///< next input to scan from
        std::uint8_t next = 0;     ///< ADCBUFn that the next result goes to
        std::uint8_t done = 0;     ///< conversions since the last interrupt
        std::uint16_t result = 0;  ///< of the conversion in progress

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(phase, Phase::Off, Phase::Converting);
            archive(phase_end, held, timed, mux_b);
            archive.bounded(channel, 0, 15);
            archive.bounded(scanned, 0, 16);
            archive.bounded(next, 0, 15);
            archive(done, result);
        }
    };

    /// A whole automatic group, to be repeated while it would give the same results.
    struct Group {
        std::uint64_t epoch = 0;                ///< of the pins (Pins::analog_epoch()); 0: none is known
        std::uint8_t channel = 0, scanned = 0;  ///< as it began
        std::uint16_t tris = 0, lat = 0;        ///< of port B
        std::array<std::uint16_t, 16> results{};
    };

    static std::uint16_t read_register(void* owner, std::uint16_t address);
    static void write_register(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_adcon1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    Trigger source() const;
    HalfCycle tad() const;
    void begin_sampling(HalfCycle at);
    void end_sampling(HalfCycle at);
    void end_conversion(HalfCycle at);
    void switch_off();
    bool goes_on_by_itself() const;
    void run_automatic(HalfCycle until);
    bool repeats() const;
    std::uint8_t scan();
    double input(int channel, Cycle at) const;
    std::uint16_t convert(Cycle at) const;
    std::uint16_t formatted(unsigned counts, unsigned form) const;
    void end_group(HalfCycle at);
    void plan();
    void note_quiet();
    /// Every read of a buffer comes to read_register() until note_quiet().
    void forget_quiet() { around_.sfr.plain().until[SfrSpace::Plain::kConverter] = 0; }

    Surroundings around_;
    const cosim::ClockDomain& clock_;
    Pins& pins_;
    State state_;
    Group group_;  ///< the last one, or the one under way
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
