#pragma once
// Steps of one motor, decoded from the levels of its four coils.
// Source: e-puck fact sheet 3.5. One table step is one motor step; 1000 steps are a wheel turn.
//
// Firmware writes the four bits one after the other, so short in-between patterns appear: a pattern counts
// once it has stood for the settle time.
//
// Deviations:
// 1. A motor never loses a step, whatever speed or load is asked of it.
// 2. At power-up the rotor stands at phase 0, where every known firmware's own phase counter starts.
// 3. While a fault holds the wheel its rotor follows the coils without turning: once free it goes on from
// there
//    (a real one snaps back by up to two steps).
// 4. A jump of two phases moves nothing (on a robot either direction may win).

#include "emu/dspic/machine/event_queue.h"

#include <cstdint>

namespace puckloop::pic {

/// Which way along the phase table is forward for the wheel.
enum class StepSense : std::int8_t { LeftMotor = -1, RightMotor = +1 };

class StepperDecoder {
  public:
    /// `settle`: cycles for which a pattern must stand.
    StepperDecoder(StepSense sense, dspic::Cycle settle) : sense_(sense), settle_(settle) {}

    /// Coil levels, bit 0 = A .. bit 3 = D, from cycle `now` on. First settles what was due before.
    void coils(std::uint8_t pattern, dspic::Cycle now);
    /// Cycle at which the present pattern becomes a step if it stays; kNoCycle if it changes nothing.
    dspic::Cycle due() const { return due_; }
    /// Takes the pending pattern if it is due at or before `now`; true if the wheel moved.
    bool settle(dspic::Cycle now);

    /// A fault keeps the wheel from turning, from what is settled later on.
    void set_held(bool held) { held_ = held; }
    std::uint64_t lost() const { return lost_; }  ///< steps that it kept from being made

    std::int64_t steps() const { return steps_; }                ///< + is forward
    std::uint8_t pattern() const { return pattern_; }            ///< coils as they stand
    std::uint64_t illegal_patterns() const { return illegal_; }  ///< stable, but neither off nor in the table
    std::uint64_t phase_jumps() const { return jumps_; }         ///< stable patterns two phases away

    template <class Archive>
    void state(Archive& archive) {
        archive(due_, steps_, illegal_, jumps_);
        archive.bounded(pattern_, 0, 15);
        archive.bounded(phase_, 0, 3);
        archive(held_, lost_);
    }

  private:
    StepSense sense_;
    dspic::Cycle settle_;
    dspic::Cycle due_ = dspic::kNoCycle;
    std::int64_t steps_ = 0;
    std::uint64_t illegal_ = 0;
    std::uint64_t jumps_ = 0;
    std::uint8_t pattern_ = 0;
    std::uint8_t phase_ = 0;
    bool held_ = false;
    std::uint64_t lost_ = 0;
};

}  // namespace puckloop::pic
