#pragma once
// Timers 0 to 3: 8 and 16 bits, every waveform mode, double-buffered compare registers, TEMP, input capture
// and compare outputs. Nothing ticks: the counter is computed when it is looked at, and an event is planned
// only where a flag would interrupt, a pin would change or a buffered value takes effect. Source: data sheet
// 8272, chapters "8-bit Timer/Counter0", "16-bit Timer/Counter1 and 3", "Timer/Counter2".
//
// Deviations
//  1. A counter above the top of a dual-slope mode turns at once.
//  2. An external clock edge counts in the clock in which the pin changes, not up to 3.5 clocks later.
//  3. A count that still belongs to the clock selected before (the clock after a write to TCCRnB) is done at
//  the write: flags that it raises and pins that it switches are one clock early.
//  4. Of timer 2 with a watch clock: compare matches go on while OCR2x or TCNT2 waits to be updated; TCNT2 is
//  right as soon as the CPU wakes; sleeping again within one cycle of the watch clock is safe; a write to a
//  register whose update flag is set replaces the one that waits.

#include "emu/avr/peripherals/interrupt_flags.h"
#include "emu/avr/peripherals/ports.h"
#include "emu/avr/peripherals/timing/prescaler.h"
#include "emu/avr/peripherals/timing/waveform.h"

#include <array>
#include <cstdint>
#include <optional>

namespace puckloop::avr {

class Timer {
  public:
    struct Setup {
        bool wide = false;            ///< 16 bits
        std::uint16_t control_a = 0;  ///< TCCRnA; TCCRnB follows
        std::uint16_t count = 0;      ///< TCNTn(L)
        std::uint16_t capture = 0;    ///< ICRnL; 0: none
        std::uint16_t compare_a = 0;  ///< OCRnA(L)
        std::uint16_t compare_b = 0;
        std::uint16_t control_c = 0;  ///< TCCRnC of 16-bit timers, else 0: FOC bits are in TCCRnB
        InterruptFlags::Setup interrupts;
        std::array<std::uint16_t, 8> dividers{};  ///< by CS bits; 0: stopped or external clock
        std::array<Pin, 2> outputs{};             ///< OCnA, OCnB
        std::optional<Pin> clock_pin{};           ///< Tn
        std::optional<Pin> capture_pin{};         ///< ICPn
        std::uint16_t power = 0;                  ///< PRRn
        std::uint8_t power_bit = 0;               ///< stops the clock
        std::uint16_t status = 0;                 ///< ASSR, of a timer that may have a clock of its own
        Pin watch_in{}, watch_out{};              ///< TOSC1 and TOSC2
    };
    /// `watch`: of a timer with Setup::status.
    Timer(const Surroundings& around, const Setup& setup, Prescaler& prescaler, Ports& ports,
          WatchClock* watch = nullptr);

    void reset();
    /// Brings counter and flags up to the present clock and plans the next event: before the prescaler or the
    /// clock changes, and behind it.
    void synchronise();
    /// The comparator takes the capture pin's place (ACIC).
    void capture_edge(bool rising);
    void use_comparator(bool on) { state_.capture_by_comparator = on; }
    InterruptFlags& flags() { return flags_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(state_);
    }

  private:
    /// A register of an asynchronous timer that takes its new value two edges of the watch clock later.
    struct Update {
        bool waits = false;
        std::uint8_t value = 0;
        std::uint64_t edge = 0;

        template <class Archive>
        void state(Archive& archive) {
            archive(waits, value, edge);
        }
    };
    static constexpr int kUpdates = 5;  ///< TCCR2B, TCCR2A, OCR2B, OCR2A, TCNT2: as their bits in ASSR
    struct State {
        Counter counter;
        Cycle at = 0;                             ///< the clock that `counter` belongs to
        bool blocked = false;                     ///< TCNT was written: the next tick compares nothing
        std::array<std::uint16_t, 2> compare{};   ///< in force
        std::array<std::uint16_t, 2> buffered{};  ///< as written
        std::uint16_t capture = 0;
        std::uint8_t temp = 0;
        std::array<bool, 2> output{};
        bool capture_by_comparator = false;
        bool capture_rising = false;  ///< the edge that waits for the noise canceler
        std::array<Update, kUpdates> updates{};

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(counter.count, 0, 0xFFFF);
            archive(counter.down, at, blocked, compare, buffered, capture, temp, output,
                    capture_by_comparator, capture_rising, updates);
        }
    };

    std::uint8_t& reg(std::uint16_t address) const { return around_.io.raw(address); }
    std::uint8_t control_a() const { return reg(setup_.control_a); }
    std::uint8_t control_b() const { return reg(static_cast<std::uint16_t>(setup_.control_a + 1)); }
    Waveform waveform() const;
    std::uint32_t max() const { return setup_.wide ? 0xFFFF : 0xFF; }
    std::uint32_t top() const;
    std::uint32_t divider() const;
    /// With this in TCCRnB.
    std::uint32_t division_of(std::uint8_t control) const;
    unsigned output_mode(int channel) const { return field(control_a(), 7 - 2 * channel, 6 - 2 * channel); }

    void settle(Cycle now);
    void pass(std::uint64_t ticks);
    void plan();
    std::uint64_t next_tick(std::uint8_t masks) const;
    bool buffers_wait() const;
    std::uint64_t until_update() const;
    void match(int channel);
    void bottom();
    void set_output(int channel, bool level);
    void connect_outputs();
    void do_capture(Cycle now);
    void set_compare(int channel, std::uint16_t value);
    void set_control(std::uint16_t address, std::uint8_t value, std::uint8_t mask);

    bool asynchronous() const { return watch_ && prescaler_.asynchronous(); }
    std::uint16_t update_address(int update) const;
    int update_of(std::uint16_t address) const;
    void write_later(std::uint16_t address, std::uint8_t value);
    void plan_updates();
    void take_updates(Cycle now);
    void watch_edge();
    static std::uint8_t read_control(void* owner, std::uint16_t address);
    static void write_status(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void update_due(void* owner, Cycle cycle);

    static std::size_t follow_count(void* owner, std::uint16_t address, Cycle first, Cycle period,
                                    std::span<std::uint8_t> values);
    static Cycle flags_change(void* owner);
    static void due(void* owner, Cycle cycle);
    static void noise_over(void* owner, Cycle cycle);
    static void touched(void* owner);
    static void pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                             Cycle now);
    static void write_control(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static void write_force(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    static std::uint8_t read_value(void* owner, std::uint16_t address);
    static std::uint8_t look_at_value(void* owner, std::uint16_t address);
    static void write_value(void* owner, std::uint16_t address, std::uint8_t value, std::uint8_t mask);
    std::uint16_t read_wide(std::uint16_t low_address);
    void write_wide(std::uint16_t low_address, std::uint16_t value);

    Surroundings around_;
    Setup setup_;
    Prescaler& prescaler_;
    Ports& ports_;
    WatchClock* watch_;
    InterruptFlags flags_;
    State state_;
    EventQueue::Slot slot_;
    EventQueue::Slot noise_slot_;
    EventQueue::Slot update_slot_;
};

}  // namespace puckloop::avr
