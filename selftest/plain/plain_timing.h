#pragma once
// Frames of a robot's control loop as they reach the host, written from the effects sheet, 57-63. With every
// knob at rest: one frame each 0.1 s, a fixed way on the wire, all frames whole.

#include "base/random.h"

namespace puckloop::gap::selftest {

struct TimingKnobs {
    double i2c_stretch = 0.0;  // [57] s a transfer
    double baud_error = 0.0;   // [58] share
    double overrun = 0.0;      // [59] probability of a lost byte at full load
    double truncated = 0.0;    // [60] probability
    double longer = 0.0;       // [61] s more than the nominal period
    double jitter = 0.0;       // [61] s
    double drift = 0.0;        // [62] share
    double batch = 0.0;        // [63] s between two deliveries of the host
    double limp = 0.0;         // unknown: s later, every seventh frame
    double sag =
        0.0;  // unknown: s that the host's clock lags in the middle of a run: it is slewed, slow then fast
};

struct Cycle {
    long number;
    double bytes, edges, i2c, load;
};

struct Arrived {
    double robot, host;
    bool ok, shifted;
};

/// Consecutive cycles of one run.
class FrameSource {
  public:
    FrameSource(const TimingKnobs& knobs, RandomStream chance) : knobs_(knobs), chance_(chance) {}
    Arrived next(const Cycle& cycle);

  private:
    TimingKnobs knobs_;
    RandomStream chance_;
    double robot_ = 0.0;
    bool broken_ = false;
};

}  // namespace puckloop::gap::selftest
