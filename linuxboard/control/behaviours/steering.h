#pragma once
// Small pieces of geometry that the behaviours with neighbours share.

#include "linuxboard/control/behaviours/behaviour.h"

namespace puckloop::control {

/// The angle in -pi..pi.
double wrapped(double angle);

/// Wheels for a speed ahead and a turn, both mm/s at the wheel, positive turn to the left.
Actuators steer(double forward, double turn);

/// Drives towards a bearing in rad: turns the more the farther it is off, drives the slower.
Actuators drive_towards(double bearing, double speed);

/// True when the proximity ring (without offsets) feels something in the direction of `bearing`.
bool touches(const std::array<double, 8>& proximity, double bearing);

/// The ring LED that looks that way, as a bit of Actuators::ring_leds.
std::uint8_t led_towards(double bearing);

}  // namespace puckloop::control
