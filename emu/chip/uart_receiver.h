#pragma once
// The serial line as a UART's receiver sees it: it looks for a start bit with its own 16x (4x) clock and
// samples the sender's waveform at its own bit centres, so a baud mismatch gives the garbage that it gives in
// silicon. Source: dsPIC30F Family Reference Manual, section 19; fact sheet peripherals.md section 1.
//
// Deviations
//  1. The majority of three samples is taken as the middle one: the waveform has no glitches shorter than a
//     sample.
//  2. A character is known only once its frame was handed in, when the sender's stop bit begins: what a
//     faster receiver samples before that instant is delivered at that instant.
//  3. A receiver that still samples after the end of all known frames waits until a next frame could no
//     longer have begun unseen: a mismatched receiver's last character may come up to one frame of the
//     sender late.

#include "cosim/core/clock.h"
#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "emu/chip/event_queue.h"

#include <cstdint>
#include <deque>
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
        Cycle done = 0;  ///< middle of the last stop bit looked at
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
    /// Nobody listens at cycle `at`: what has passed by then is of no use.
    void pass(Cycle at) { forget_before(clock_.time_of(at)); }
    /// The next character, if all that it depends on is known at cycle `now`.
    std::optional<Character> next(const Format& format, Cycle now);
    /// When next() is worth asking again although no frame came; kNoCycle if only a frame can help.
    Cycle ask_again() const { return ask_again_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(frames_, ask_again_);
        archive.bounded(listening_from_, 0, cosim::kNever);
        for (const cosim::UartFrame& frame : frames_)
            archive.check(frame.bit_period > 0, "a frame without a bit period");
    }

  private:
    bool level(cosim::Time time) const;
    std::optional<cosim::Time> falling_edge(cosim::Time from) const;
    cosim::Time first_high(cosim::Time from) const;
    void forget_before(cosim::Time time);

    const cosim::ClockDomain& clock_;
    std::deque<cosim::UartFrame> frames_;
    cosim::Time listening_from_ = 0;
    Cycle ask_again_ = kNoCycle;
};

}  // namespace puckloop::chip
