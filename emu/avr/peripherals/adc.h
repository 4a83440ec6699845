#pragma once
// The analog-to-digital converter: single, free-running and auto-triggered conversions, 13 ADC clocks each,
// the first one after enabling 25. Source: data sheet 8272, "Analog-to-digital Converter".
//
// Deviations
//  1. The gain stage and the internal 1.1 V and 0 V channels are ideal: no offset, no bandwidth, no noise.
//  2. Sleep has no effect on the result.
//  3. A trigger resets the ADC's prescaler in the clock of the trigger.

#include "emu/avr/peripherals/pins.h"
#include "emu/avr/peripherals/surroundings.h"

#include <cstdint>
#include <functional>

namespace puckloop::avr {

class Adc {
  public:
    /// Volts of AVCC and AREF.
    struct References {
        double avcc = 5.0;
        double aref = 5.0;
    };
    Adc(const Surroundings& around, Pins& pins, const References& references);

    void reset();
    /// The source of auto-triggering `number` (ADTS2:0) had its edge.
    void trigger(unsigned number);
    /// The source that is waited for; 0: none.
    unsigned trigger_source() const;
    /// Called when trigger_source() may have changed.
    std::function<void()> source_changed;
    /// The flag of the source is set already: whether choosing it is an edge.
    std::function<bool(unsigned number)> source_set;
    /// Called when the multiplexer or its enable changed, which the comparator may use.
    std::function<void()> input_changed;
    /// The CPU halts in a mode in which a conversion begins by itself.
    void quiet();
    /// Volts of AVCC from now on.
    void set_avcc(double volts) { references_.avcc = volts; }
    bool converting() const { return state_.converting; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    struct State {
        bool converting = false;
        bool sampled = false;  ///< the input was held; the rest is approximation
        bool first = true;     ///< the next conversion initialises the converter
        Cycle phase = 0;       ///< the prescaler started here
        Cycle end = 0;
        std::uint16_t held = 0;
        std::uint16_t result = 0;
        bool locked = false;  ///< ADCL was read: the result stays until ADCH is
        Cycle begin = 0;      ///< of the conversion: its channel and reference stay from here on
        std::uint8_t mux = 0;
        unsigned source = 0;  ///< trigger_source() as it was last

        template <class Archive>
        void state(Archive& archive) {
            archive(converting, sampled, first, phase, end, held, result, locked, begin, mux, source);
        }
    };
    std::uint8_t& control() const { return around_.io.raw(0x7A); }
    Cycle clocks_per_tick() const;
    void start(Cycle now, bool triggered);
    std::uint16_t convert(Cycle now) const;
    void finish(Cycle now);
    void update_request();

    static void due(void* owner, Cycle cycle);
    static std::uint8_t read_result(void* owner, std::uint16_t address);
    static std::uint8_t look_at_result(void* owner, std::uint16_t address);
    static void write_result(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_mux(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_source(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void acknowledge(void* owner, int vector);
    void update_source();

    Surroundings around_;
    Pins& pins_;
    References references_;
    State state_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::avr
