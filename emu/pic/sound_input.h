#pragma once
// The wave at a microphone as it is sent sample by sample: straight lines between samples kSoundPeriod apart,
// one period late.

#include "emu/dspic/machine/event_queue.h"

namespace puckloop::pic {

/// Seconds between the samples of a `sound` signal while there is any (physics/sensors/sound_waves.h).
inline constexpr double kSoundPeriod = 62.5e-6;

class SoundInput {
  public:
    explicit SoundInput(double period_cycles) : period_(period_cycles) {}

    void set(double counts, dspic::Cycle now) {
        from_ = at(now);
        to_ = counts;
        since_ = now;
    }
    /// May be asked somewhat before the last change: the wave had not begun its last line then.
    double at(dspic::Cycle now) const {
        if (now <= since_) return from_;
        const double share = static_cast<double>(now - since_) / period_;
        return share < 1.0 ? from_ + (to_ - from_) * share : to_;
    }

    /// From here on at() stays the same until set().
    dspic::Cycle settled_from() const { return since_ + static_cast<dspic::Cycle>(period_) + 2; }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(from_, -1e6, 1e6);
        archive.bounded(to_, -1e6, 1e6);
        archive(since_);
    }

  private:
    double period_;
    double from_ = 0.0, to_ = 0.0;
    dspic::Cycle since_ = 0;
};

}  // namespace puckloop::pic
