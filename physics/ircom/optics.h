#pragma once
// How much of one infra-red diode's light arrives at one phototransistor: e-pucks' proximity sensors and the
// TAM's transceiver, which are the same part (TCRT1000).
//
// The unit is counts of the e-puck's A/D converter by which a phototransistor's voltage changes. The curve of
// distance is made so that two robots face to face, all diodes on, show the amplitudes that IRcom's authors
// measured at 7.5 to 22 cm between centres (e-puck fact sheet 3.10). Lobes are cosines to a power.
//
// Deviations: 1. Everything happens in plan, at the sensors' height. 2. Straight ways only: no reflections,
// from walls or from the body of the robot that sends. 3. All diodes and phototransistors are alike but for
// the robots' parameters ircom.power and ircom.gain. 4. Phototransistors neither saturate nor slow down with
// the light (the converter clips).

#include "physics/description/parameters.h"
#include "physics/description/plan.h"

#include <array>
#include <span>

namespace puckloop::physics {

/// A diode or phototransistor, in whatever frame: place, and the way it looks (a unit vector).
struct IrcomPart {
    double x = 0.0, y = 0.0, dx = 1.0, dy = 0.0;
};
/// `own` in the frame of a body at (x, y) whose heading has this cosine and sine.
IrcomPart in_world(const IrcomPart& own, double x, double y, double cosine, double sine);

/// The eight sensors of a robot in its own frame; each has a diode and a phototransistor.
std::array<IrcomPart, kProximitySensors> ircom_parts(const ProximityParameters& parameters);

/// Counts from one diode over a free way of `metres`, both parts looking at each other.
double ircom_level(double metres);
/// Counts that `from` brings to `to` with nothing in between: 0 behind either, or beyond ircom.reach.
double ircom_counts(const IrcomPart& from, const IrcomPart& to, const IrcomParameters& parameters);
/// Does one of `shapes` stand in the way?
bool ircom_shaded(const IrcomPart& from, const IrcomPart& to, std::span<const Shape* const> shapes);

}  // namespace puckloop::physics
