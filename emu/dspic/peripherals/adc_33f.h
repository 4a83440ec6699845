#pragma once
// The 33FJ's A/D converters: 10 or 12 bits, up to 32 inputs, scan, alternating multiplexers, up to four
// channels with 10 bits, one result register and a DMA request a conversion. Source: DS70286; fact sheet
// peripherals.md section 3.
//
// Deviations
//  1. The internal RC clock (ADRC = 1) has TAD = 250 ns exactly.
//  2. No settling time after ADON, no acquisition error, no noise, no time between trigger and start: the
//     input is taken at the end of sampling. With several channels and SIMSAM = 0 each is taken when its
//     conversion begins.
//  3. Selections of the input (ADxCHS0, ADxCSSL/H) count at the start of sampling.
//  4. Reserved SSRC codes and the motor PWM's (011) never end sampling.
//  5. ADxIF comes after SMPI + 1 groups, a DMA request with every conversion. DMABL, ADDMABM and BUFM are
//     stored: the DMA channel stores in conversion order.

#include "cosim/core/clock.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"

#include <array>
#include <cstdint>

namespace puckloop::dspic {

class Adc33F {
  public:
    enum class Trigger : std::uint8_t { Software = 0, Int0 = 1, Timer = 2, Counter = 7 };
    struct Setup {
        std::uint16_t buf0 = 0;
        std::uint16_t con1 = 0;       ///< ADxCON1; CON2, CON3, CHS123, CHS0 follow
        std::uint16_t pcfg_high = 0;  ///< 0: none
        std::uint16_t pcfg_low = 0;
        std::uint16_t css_high = 0;  ///< 0: none
        std::uint16_t css_low = 0;
        std::uint16_t con4 = 0;
        std::uint8_t irq = 0;
        int inputs = 16;
    };
    Adc33F(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
           Pins& pins);

    void reset();
    /// INT0 edge or match of the timer that belongs to this converter: ends sampling if SSRC selects it.
    void trigger(Trigger source, Cycle at);
    /// Sleep without the internal RC clock, or Idle with ADSIDL set.
    void hold(bool on);
    bool runs_in_sleep() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    static constexpr int kChannels = 4;
    enum class Phase : std::uint8_t { Off, Idle, Sampling, Converting };
    struct State {
        Phase phase = Phase::Off;
        bool held = false;
        bool mux_b = false;
        std::uint8_t input = 0;    ///< of channel 0, being sampled or converted
        std::uint8_t scanned = 0;  ///< next input to scan from
        std::uint8_t groups = 0;   ///< since the last interrupt
        std::uint8_t channel = 0;  ///< being converted
        std::array<std::uint16_t, kChannels> results{};

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(phase, Phase::Off, Phase::Converting);
            archive(held, mux_b);
            archive.bounded(input, 0, 31);
            archive.bounded(scanned, 0, 32);
            archive(groups);
            archive.bounded(channel, 0, kChannels - 1);
            archive(results);
        }
    };

    static void write_con1(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con2(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con3(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void due(void* owner, Cycle due);

    Trigger source() const;
    bool twelve_bits() const;
    int channels() const;
    Cycle tad() const;
    Cycle conversion_cycles() const;
    std::uint8_t scan();
    void begin_sampling(Cycle at);
    void end_sampling(Cycle at);
    void end_conversion(Cycle at);
    void group_done(Cycle at);
    std::uint16_t convert(int channel, Cycle at) const;
    double positive(int channel, Cycle at) const;
    double negative(int channel, Cycle at) const;
    double input(int number, Cycle at) const;
    std::uint16_t& con(int number) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con1 + 2 * (number - 1)));
    }
    std::uint16_t& chs123() const { return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con1 + 6)); }
    std::uint16_t& chs0() const { return around_.sfr.raw(static_cast<std::uint16_t>(setup_.con1 + 8)); }

    Surroundings around_;
    Setup setup_;
    const cosim::ClockDomain& clock_;
    Ports& ports_;
    Pins& pins_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
