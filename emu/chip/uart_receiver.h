#pragma once
// The serial line as a UART's receiver sees it: it looks for a start bit with its own 16x (4x) clock and
// samples the sender's waveform at its own bit centres, so a baud mismatch gives the garbage that it gives in
// silicon. With 16 and 8 clocks a bit the majority of three samples in its middle counts, with 4 one sample;
// a start bit is one if it is low there, and seen only if a sample falls into it. Sources: dsPIC30F Family
// Reference Manual, section 19; dsPIC33 manual on the UART, DS70000582, section 6 (samples 7, 8 and 9; one
// with 4 clocks); ATmega1284P data sheet 8272, "Asynchronous Data Reception" (samples 8, 9 and 10, or 4, 5
// and 6, counted from the first low one).
//
// Deviations
//  1. Where no level lasts less than three sampling clocks the middle one of three samples is taken, which is
//     their majority then.
//  2. A character is known only once its frame was handed in, when the sender's stop bit begins: what a
//     faster receiver samples before that instant is delivered from that instant on, one character after the
//     other in the receiver's own time.
//  3. A receiver that still samples after the end of all known frames waits until a next frame could no
//     longer have begun unseen: a mismatched receiver's last character may come up to one frame of the
//     sender late.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/chip/event_queue.h"
#include "protocols/serial/uart_line.h"

#include <cstdint>
#include <optional>

namespace puckloop::chip {

class UartReceiver {
  public:
    struct Format {
        std::uint32_t divisor = 16;  ///< cycles between sampling clocks: BRG + 1
        int data_bits = 8;
        int parity = 0;            ///< 0 none, 1 odd, 2 even
        Cycle phase = 0;           ///< a cycle in which the sampling clock ticks
        std::uint32_t ticks = 16;  ///< sampling clocks in a bit; 4 with BRGH = 1
        int stop_bits = 1;         ///< that are looked at
    };
    struct Character {
        Cycle done = 0;  ///< middle of the last stop bit looked at, or later (deviation 2)
        std::uint16_t data = 0;
        bool framing_error = false;
        bool parity_error = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(done, data, framing_error, parity_error);
        }
    };

    explicit UartReceiver(const cosim::ClockDomain& clock) : clock_(clock) {}

    /// Forgets everything; looks for falling edges from cycle `at` on.
    void start(Cycle at);
    /// A frame on the line; frames come in order of their starts.
    void frame(const cosim::UartFrame& frame);
    /// Something between line and receiver was switched at cycle `at`: from there on it sees the line at
    /// rest, or what is left of the frames on it, as this level; frames to come are handed in as it sees
    /// them.
    void set_rest(bool high, Cycle at);
    bool level(Cycle at) const { return line_.level(clock_.time_of(at)); }
    /// Nobody listens at cycle `at`: what has passed by then is of no use.
    void pass(Cycle at) { line_.forget_before(clock_.time_of(at)); }
    /// The next character, if all that it depends on is known at cycle `now`.
    std::optional<Character> next(const Format& format, Cycle now);
    /// When next() is worth asking again although no frame came; kNoCycle if only a frame can help.
    Cycle ask_again() const { return ask_again_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(line_, ask_again_, newest_);
        archive.bounded(listening_from_, 0, cosim::kNever);
        archive.bounded(switched_at_, kNotSwitched, cosim::kNever);
    }

  private:
    /// What it samples in the bit whose middle is at this cycle.
    bool sample(const Format& format, Cycle middle, bool exact) const;
    bool may_change(cosim::Time time, Cycle now, cosim::Time own_flight, bool exact);

    const cosim::ClockDomain& clock_;
    protocols::UartLine line_;
    cosim::Time listening_from_ = 0;
    Cycle ask_again_ = kNoCycle;
    Cycle newest_ = 0;  ///< the newest character was delivered
    static constexpr cosim::Time kNotSwitched = -1;
    cosim::Time switched_at_ = kNotSwitched;  ///< the level since then is a guess, until a frame begins
};

}  // namespace puckloop::chip
