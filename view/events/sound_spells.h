#pragma once
// When a robot's speaker plays, from the samples that drive it: a wave passes 0 thousands of times a second,
// and a sound has ended when it stays there.

#include <optional>

namespace puckloop::view {

class SoundSpells {
  public:
    /// A change; `sound` is called with (time, whether it plays from then on), perhaps twice.
    template <class Sound>
    void sample(double time, bool silent, Sound sound) {
        settle(time, sound);
        if (silent && plays_) {
            silent_since_ = time;
        } else if (!silent) {
            silent_since_.reset();
            if (!plays_) sound(time, true);
            plays_ = true;
        }
    }
    /// It was silent for long enough by `time`, or is not.
    template <class Sound>
    void settle(double time, Sound sound) {
        if (!silent_since_ || time - *silent_since_ < kPause) return;
        sound(*silent_since_, false);
        silent_since_.reset();
        plays_ = false;
    }

  private:
    static constexpr double kPause =
        0.02;  // s: half a period of the lowest tone that a speaker so small can play
    bool plays_ = false;
    std::optional<double> silent_since_;
};

}  // namespace puckloop::view
