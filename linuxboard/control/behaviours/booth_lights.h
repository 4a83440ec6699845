#pragma once
// The lights of a booth (TAM) as one thing: where it is, and which way it opens.
//
// A booth has three lights in a row, 25 mm apart and parallel to its opening. Their direction in the picture
// gives the axis along which a robot gets in; from beside the axis a side of the booth hides one or two of
// them.

#include "linuxboard/control/behaviours/behaviour.h"

#include <optional>
#include <vector>

namespace puckloop::control {

struct BoothLights {
    ColouredSpot middle;  ///< colour, sum of the areas, and the mean place weighted by area
    /// rad, counter-clockwise, from the way lights-robot to the booth's axis, both seen from the lights: > 0
    /// if the axis passes on the robot's right when it faces them. None where fewer than two lights can be
    /// distinguished.
    std::optional<double> askew;
};

/// Spots of one colour less than a booth's width apart are one booth's; in the order of their largest spots.
std::vector<BoothLights> booths_of(const std::vector<ColouredSpot>& spots);

/// Where to drive: bearing in rad of the point on the booth's axis that is `ahead` times the distance of the
/// lights before them.
double bearing_of_axis(const ColouredSpot& lights, double askew, double ahead);

}  // namespace puckloop::control
