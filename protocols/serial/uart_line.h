#pragma once
// A serial line as the frames on it make it, level by level, and a receiver that looks at it without a
// sampling clock: each bit once, in its middle, counted from the start bit's edge (as a PC's UART, whose 16
// ticks a bit the model does not count).

#include "cosim/core/message.h"
#include "cosim/core/message_state.h"
#include "cosim/core/time.h"
#include "protocols/serial/uart_sampling.h"

#include <deque>
#include <optional>
#include <vector>

namespace puckloop::protocols {

/// No character but a level, from `from` on up to whatever comes next. `bit`: the bit time of
/// its sender, whose frames are known as late as this level.
cosim::UartFrame line_level(bool high, cosim::Time from, cosim::Time bit);

/// Frames in order of their starts. Where two overlap, the later one has the line, of two that begin together
/// the one that was added later.
class UartLine {
  public:
    void add(const cosim::UartFrame& frame);
    void clear() { frames_.clear(); }
    bool empty() const { return frames_.empty(); }
    const cosim::UartFrame& last() const { return frames_.back(); }

    /// High before the first frame.
    bool level(cosim::Time time) const;
    /// The first change from high to low at or after `from`.
    std::optional<cosim::Time> falling_edge(cosim::Time from) const;
    /// When the line is first high at or after `from`; `from` if it never is.
    cosim::Time first_high(cosim::Time from) const;
    /// No frame is on the line at `time`, and it is high just before.
    bool at_rest(cosim::Time time) const;
    /// Frames that are over by `time` and whose successor has begun are of no use any more.
    void forget_before(cosim::Time time);
    /// Up to when no further frame is to be expected, as senders send one after the other.
    cosim::Time known_until() const;
    /// All levels are those of a sound line (cosim::is_sound()), and none lasts less than `shortest`.
    bool sound(cosim::Time shortest = 0) const;
    /// Longest time from the start of one of the frames to its stop bit: what is unknown of the line at t is
    /// known so much later.
    cosim::Time longest_flight() const;

    template <class Archive>
    void state(Archive& archive) {
        archive(frames_);
        for (const cosim::UartFrame& frame : frames_)
            archive.check(frame.bit_period > 0, "a frame without a bit period");
    }

  private:
    std::optional<cosim::Time> sound_falling_edge(cosim::Time from) const;
    /// The next instant after `time` at which the level may be another, or kNever.
    cosim::Time next_change(cosim::Time time) const;

    std::deque<cosim::UartFrame> frames_;
};

/// What a receiver takes off a line, character by character. On a sound line each frame is sampled when it is
/// handed in (sample_frame()). Else the line as a whole is, and a character that a frame still to come may
/// change waits until it cannot.
class UartListener {
  public:
    /// A frame, known at `now`: the characters that are certain then.
    std::vector<ReceivedCharacter> add(const cosim::UartFrame& frame, const UartReceiver& receiver,
                                       cosim::Time now);
    /// No other frame came before `now`: those that have become certain.
    std::vector<ReceivedCharacter> pass(const UartReceiver& receiver, cosim::Time now);
    /// add() would sample this frame by itself, from ready() on.
    bool samples_alone(const cosim::UartFrame& frame) const;
    cosim::Time ready() const { return ready_; }
    /// When pass() is worth a call; kNever if nothing waits.
    cosim::Time ask_again() const { return ask_again_; }
    /// What is on the way is of no use any more.
    void reset();

  private:
    UartLine line_;
    cosim::Time ready_ = 0;  ///< looks for a start bit from then on
    cosim::Time ask_again_ = cosim::kNever;
};

}  // namespace puckloop::protocols
