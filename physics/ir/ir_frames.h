#pragma once
// What was on the air, by the medium's own account: each frame, and for each board whether it could hear it
// and what else shone on it meanwhile. The ground truth beside which the boards' own results are held.
//
// A frame begins with the first emitter on and ends when all have been dark for more than three chips. Frames
// sent back to back are distinguished by their preambles: light for four chips or more does not occur
// elsewhere.
//
// File (CSV), one row per frame and receiver, in the order in which frames are known to have ended: t_s and
// end_s first and last light; sender; receiver; distance_m between the bodies; level_counts and carrier: the
// strongest of the twelve receivers, carrier in thresholds; receivers: how many were above threshold; heard:
// 1 if any was; overlap: other boards, joined by '+', whose frames overlapped it and could be heard there;
// receiver_sending: 1 if the receiver itself was on the air meanwhile.

#include "cosim/core/time.h"
#include "physics/ir/ir_medium.h"
#include "physics/world/recorder.h"

#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace puckloop::physics {

class IrFrames {
  public:
    /// `file` may be empty: then only counts are kept. Throws RunError as CsvFile does.
    IrFrames(const IrMedium& medium, const std::string& file);

    /// The board's light went on or off. True: a new frame begins, so that noise is to be drawn.
    bool edge(cosim::Time now, std::size_t sender, bool lit);
    /// To be called when the light of a board that is lit has changed.
    void seen(std::size_t sender);
    /// Writes the frames that have ended by now.
    void close_until(cosim::Time now);
    /// Ends all frames; returns the report: an array, one object a receiver.
    std::string finish();

    /// What was counted, without the rows: they are kept back from mark() on, as CsvFile does.
    template <class Archive>
    void state(Archive& archive) {
        archive(senders_, counts_, past_);
    }
    void mark() {
        if (csv_) csv_->mark();
    }
    void rewind() {
        if (csv_) csv_->rewind();
    }
    void settle() {
        if (csv_) csv_->settle();
    }

  private:
    struct Heard {
        float level = 0.0F, carrier = 0.0F;
        std::uint16_t receivers = 0;  // above threshold
        double distance = 0.0;
    };
    struct Frame {
        std::size_t sender = 0;
        cosim::Time start = 0, end = cosim::kNever;  // first and last light
        std::vector<Heard> at;

        template <class Archive>
        void state(Archive& archive) {
            archive(sender, start, end, at);
        }
    };
    struct Sender {
        std::optional<Frame> frame;
        cosim::Time run_start = 0;   // of the present or last stretch of light
        cosim::Time run_before = 0;  // end of the one before
        bool lit = false;

        template <class Archive>
        void state(Archive& archive) {
            archive(frame, run_start, run_before, lit);
        }
    };
    struct Count {
        std::uint64_t frames = 0, heard = 0, overlapped = 0, own_heard = 0;
        double longest = 0.0, farthest = 0.0;
    };

    void begin(std::size_t sender, cosim::Time start);
    void close(std::size_t sender);
    void write(const Frame& frame);
    void write(const Frame& frame, std::size_t receiver);
    /// Frames whose light overlaps the given one's.
    std::vector<const Frame*> beside(const Frame& frame) const;

    const IrMedium& medium_;
    std::vector<Sender> senders_;
    std::vector<Count> counts_;
    std::deque<Frame> past_;  // ended, but perhaps beside one that has not
    std::vector<cosim::Time> chip_;
    std::unique_ptr<CsvFile> csv_;
};

}  // namespace puckloop::physics
