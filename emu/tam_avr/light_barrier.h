#pragma once
// A light barrier of the TAM: an infra-red LED, and a phototransistor across the booth with 10 kilohms to
// ground, so that more light makes more volts. Source: TAM fact sheet, sections 2 and 4.
//
// Deviations:
// 1. The signal of a free beam at the firmware's duty (55 of 256) is a parameter, 1 V unless given: the fact
//    sheet knows only that a beam of less than 0.387 V counts as interrupted. It is proportional to the duty.
// 2. One time constant for LED and phototransistor, rise and fall.
// 3. The 97 kHz pulses of the LED driver are seen as their mean.

#include "cosim/core/time.h"

namespace puckloop::tam {

struct LightBarrierParameters {
    double lit_volts = 1.0;                                ///< of a free beam at kFirmwareDuty; 0..3.3
    cosim::Time time_constant = 50 * cosim::kMicrosecond;  ///< > 0; an assumption
};

class LightBarrier {
  public:
    /// Share of the time for which the firmware lets its infra-red LEDs shine.
    static constexpr double kFirmwareDuty = 55.0 / 256.0;

    explicit LightBarrier(const LightBarrierParameters& parameters) : parameters_(parameters) {}

    void set_ambient(double volts) { ambient_ = volts; }
    /// A fault's light, as a share of the supply.
    void set_glare(double share) { glare_ = share; }
    /// Part of the beam that is interrupted, 0..1.
    void set_interrupted(double part, cosim::Time now);
    /// Share of the time that the LED is on, 0..1.
    void set_duty(double duty, cosim::Time now);
    /// Volts at the sensor, 0..3.3.
    double volts(cosim::Time now) const;

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(ambient_, 0.0, 5.0);
        archive.bounded(glare_, 0.0, 1.0);
        archive.bounded(interrupted_, 0.0, 1.0);
        archive.bounded(duty_, 0.0, 1.0);
        archive.bounded(at_edge_, 0.0, 100.0);
        archive.bounded(edge_, 0, cosim::kNever);
    }

  private:
    double beam(cosim::Time now) const;
    double settled() const { return parameters_.lit_volts / kFirmwareDuty * duty_ * (1.0 - interrupted_); }

    LightBarrierParameters parameters_;
    double ambient_ = 0.0, glare_ = 0.0, interrupted_ = 0.0, duty_ = 0.0;
    double at_edge_ = 0.0;  ///< volts of the beam when it last changed
    cosim::Time edge_ = 0;
};

}  // namespace puckloop::tam
