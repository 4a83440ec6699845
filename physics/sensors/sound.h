#pragma once
// The sound of loudspeakers at a robot's three microphones, as volumes: what firmware makes of a window of
// samples (largest minus smallest). The board makes a waveform of it (emu/pic/microphone.h). Sources: physics
// facts 4 (law, directivity, floors: measured on an e-puck2); places and directions are plausible only.
//
// Deviations: 1. sound takes no time and knows no phase: a source cannot be located by delays. 2. Nothing
// shades or reflects it; microphone.exponent represents a room. 3. Directions count in plan.

#include "physics/description/description.h"
#include "physics/description/parameters.h"
#include "physics/dynamics/dynamics.h"

#include <array>
#include <span>

namespace puckloop::physics {

class Ears {
  public:
    /// `speakers` must outlive it.
    Ears(const MicrophoneParameters& parameters, std::span<const Speaker> speakers);

    /// Others stand there now; `speakers` must outlive it.
    void set_speakers(std::span<const Speaker> speakers) { speakers_ = speakers; }
    /// Is there anything to hear?
    bool any() const;
    /// Levels at `seconds`, counts, 0..4095: loudspeakers by distance and direction, their powers added, then
    /// the robot's own noise. `motor_speed`: steps/s without sign, mean of the two motors.
    std::array<double, kMicrophones> hear(const RobotState& robot, double seconds, double motor_speed) const;

  private:
    MicrophoneParameters parameters_;
    std::span<const Speaker> speakers_;
};

}  // namespace puckloop::physics
