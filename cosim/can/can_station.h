#pragma once
// One controller on a CAN bus, bit by bit: its bit clock, what it drives, what it makes of what it samples,
// and its error counters. Source: Bosch CAN specification 2.0, parts A and B (sections named as there).
//
// A station knows no other: the wire (can_wire.h) asks when something happens next, reports falling edges
// and hands in the level at each sample.
//
// Deviations
//  1. An edge is seen when it happens, not with the next quantum; edges synchronise as the specification has
//     it: hard at a start of frame, else by at most the jump width and once a bit.
//  2. Bit errors within a station's own error or overload flag do not begin another one.
//  3. A receive error counter above 127 is set to 127 by a good frame (the specification: 119 to 127).

#include "cosim/core/time.h"
#include "protocols/can/can_frame.h"
#include "protocols/can/can_reader.h"

#include <cstdint>
#include <optional>
#include <utility>

namespace puckloop::cosim {

/// How a controller cuts time, ps.
struct CanTiming {
    Time bit = 1'000'000;
    Time sample = 750'000;  ///< from the bit's begin
    Time jump = 0;          ///< most that an edge moves the bit
};

/// A frame that a controller wants to send.
struct CanOffer {
    protocols::CanFrame frame;
    protocols::CanBits bits;
    std::uint8_t tag = 0;
};

/// What a station has to say at the end of a frame or an error frame.
struct CanNews {
    enum class What : std::uint8_t { Sent, Received, Error, BusOff, Recovered } what = What::Error;
    Time start = 0;             ///< of the frame
    protocols::CanFrame frame;  ///< sent, received, or under way if `sender`
    protocols::CanError error = protocols::CanError::None;
    std::uint8_t position = 0;  ///< bits to the one in which the error was found
    std::uint8_t tag = 0;
    bool sender = false;  ///< Error: of this station's own frame
    bool lost = false;    ///< it had begun a frame and lost arbitration
    bool gone = false;    ///< the frame that it was about was withdrawn
};

class CanStation {
  public:
    /// On the bus from now on; `quiet_since`: the wire has been recessive since then.
    /// Counters begin at `tec` and `rec`.
    void join(const CanTiming& timing, bool listens, Time now, Time quiet_since, unsigned tec = 0,
              unsigned rec = 0);
    void leave();
    /// Nothing that it would still do matters to others: it may leave or join anew.
    bool may_leave() const;
    bool on() const { return state_.phase != Phase::Off; }
    /// Replaces what was offered and has not begun.
    void offer(const CanOffer& offer, Time now);
    /// True: nothing is under way, and nothing will be sent. False: news of the frame is still to come.
    bool withdraw();

    /// Begin of the next bit, or its sample; kNever: nothing happens by itself.
    Time next_event() const;
    bool samples_next() const { return state_.sample_due; }
    bool drives_low() const { return state_.low; }
    /// The next bit begins now.
    void begin_bit(Time now);
    /// The wire, as this station sees it, falls.
    void fall(Time now);
    /// News belong to the end of this bit (next_bit()): they are known before they count.
    std::optional<CanNews> sample(bool level);
    Time next_bit() const { return state_.next_bit; }

    /// A frame that this station alone now sends: arbitration has just been won, with this sample.
    /// Reported once.
    bool take_won() { return std::exchange(state_.won, false); }
    const CanOffer& sending() const { return sending_; }
    Time frame_start() const { return state_.frame_start; }
    /// The bit of the frame that is sampled next, the start of frame 0; -1: there is no frame.
    int frame_bit() const { return state_.phase == Phase::Frame ? state_.reader.taken() : -1; }
    /// In a frame or an error frame.
    bool busy() const {
        return state_.phase == Phase::Frame || state_.phase == Phase::Flag ||
               state_.phase == Phase::Delimiter;
    }
    bool wants_to_send() const { return state_.pending; }
    const CanTiming& timing() const { return state_.timing; }

    /// No news before this; kNever: none by itself. `stirs`: somebody else may begin a frame at `now`.
    Time earliest_news(Time now, bool stirs) const;

    unsigned transmit_errors() const { return state_.tec; }
    unsigned receive_errors() const { return state_.rec; }
    bool passive() const { return state_.tec > kMostActive || state_.rec > kMostActive; }
    bool bus_off() const { return state_.tec > kMostPassive; }
    bool listens() const { return state_.listens; }

    static constexpr unsigned kMostActive = 127, kMostPassive = 255;  ///< counts
    /// Behind the bit with an error to the end of its frame: flag and delimiter, at least.
    static constexpr int kErrorBits = 6 + 8;

  private:
    enum class Phase : std::uint8_t {
        Off,
        Integrating,  ///< until 11 recessive bits
        Idle,
        Frame,
        Flag,       ///< of an error or overload frame
        Delimiter,  ///< of either, from the end of its own flag on
        Intermission,
        Suspend,  ///< 8 bits in which an error passive sender lets others begin
        BusOff,
    };
    struct State {
        Phase phase = Phase::Off;
        Phase next = Phase::Off;  ///< with the next bit; the same as `phase`: goes on
        CanTiming timing;
        bool listens = false;
        Time next_bit = kNever, next_sample = kNever;
        bool sample_due = false;    ///< the sample comes before the next bit
        bool low = false;           ///< what it drives
        bool was_recessive = true;  ///< the last sample
        bool synchronised = false;  ///< by an edge, since then
        std::uint16_t count = 0;    ///< bits of the phase; of BusOff: sequences of 11
        std::uint16_t bits = 0;     ///< of BusOff
        std::uint8_t run = 0;       ///< equal bits in a row
        bool run_level = protocols::kRecessive;
        bool after_flag = false;  ///< the next bit is the first behind the flag
        // The frame.
        protocols::CanReader reader;
        Time frame_start = 0;
        std::uint8_t index = 0;  ///< of the bit that it sends
        bool may_join = false, sends = false, lost = false, won = false, acknowledges = false;
        // What is wanted.
        bool pending = false;   ///< `offered_` is to be sent
        bool once = false;      ///< what is under way is not repeated
        bool replaced = false;  ///< what is under way is not `offered_`
        // The error or overload frame.
        bool overload = false, active_flag = false, was_sender = false;
        bool unpunished = false;  ///< nobody acknowledged a passive sender, and nobody has spoken since
        bool reports = false;     ///< news is due at its end
        protocols::CanError error = protocols::CanError::None;
        std::uint8_t error_at = 0;
        bool suspends = false;  ///< it has sent, and is passive
        std::uint16_t tec = 0, rec = 0;
    };

    void begin_frame(Time now, bool may_join);
    void start(Time now);
    void synchronise(Time now);
    void sample_frame(bool level);
    void sample_sent(bool level, protocols::CanError error);
    void sample_flag(bool level);
    void sample_delimiter(bool level);
    void sample_bus_off(bool level);
    /// An error or overload flag begins with the next bit.
    void fail(protocols::CanError error, bool counts = true);
    void begin_overload();
    void punish(bool sender, int step);
    void take_sample(bool level);
    /// What this bit, now sampled, ended.
    std::optional<CanNews> conclude();
    CanNews frame_ended();
    /// The phase that is `next` begins.
    void enter_next(Time now);
    CanNews news(CanNews::What what) const;

    State state_;
    CanOffer offered_;  ///< to be sent, or sent again
    CanOffer sending_;  ///< under way
};

}  // namespace puckloop::cosim
