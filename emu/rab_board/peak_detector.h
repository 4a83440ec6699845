#pragma once
// One peak detector: it follows a rising level at once, holds the highest, droops slowly towards what stands
// at its input, and is discharged while its reset line is on. Source: range-and-bearing fact sheet 4.1, 5.2,
// 5.3.
//
// Deviations: 1. it charges without delay and without a diode's drop. 2. While reset is on, the level goes to
// zero whatever the input, and the input is back at once when it ends.

#include "cosim/core/time.h"

namespace puckloop::rab {

struct PeakDetectorParameters {
    /// Discharge while reset is on, s. The vendor: 1.5 us was too short, 3.5 us empties it.
    double reset_time_constant_s = 1e-6;
    /// Leak of the hold capacitor, s. No figure is known. The board reads twelve channels one after the other
    /// over 2.4 ms, which asks for less than a count in that time: 20 s is half a count at full scale.
    double droop_time_constant_s = 20.0;
};

class PeakDetector {
  public:
    explicit PeakDetector(const PeakDetectorParameters& parameters, double input = 0.0);

    /// The level at the input is `counts` from `now` on. Calls of both in time order.
    void set_input(double counts, cosim::Time now);
    void set_reset(bool on, cosim::Time now);

    /// Level at the hold capacitor, counts. May be asked for times before the last change, back to the change
    /// before it.
    double level(cosim::Time now) const;
    bool resetting() const { return present_.reset; }
    double input() const { return present_.input; }

    template <class Archive>
    void state(Archive& archive) {
        archive(present_, before_);
    }

  private:
    /// From one change to the next.
    struct Stretch {
        cosim::Time since = 0;
        double level = 0.0;  ///< at `since`
        double input = 0.0;
        bool reset = false;
        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(since, 0, cosim::kNever);
            archive.bounded(level, -1e6, 1e6);
            archive.bounded(input, -1e6, 1e6);
            archive(reset);
        }
    };
    double level(const Stretch& stretch, cosim::Time now) const;
    void change(double input, bool reset, cosim::Time now);

    PeakDetectorParameters parameters_;
    Stretch present_;
    Stretch before_;
};

}  // namespace puckloop::rab
