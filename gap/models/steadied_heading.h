#pragma once
// The heading that turns a tracker's steps into along and across: neither the tracker's, which is noisy and
// makes the sums wander, nor the wheels', which a wrong parameter turns away, but the wheels' carried along
// the tracker's.

#include <span>
#include <vector>

namespace puckloop::gap {

/// Errors of measured headings. `above`: measured minus predicted, rad, a row each; `time`: s, ascending.
/// What `above` keeps for longer than `span` seconds is taken for the robot's own, the rest for the
/// tracker's. Deviation: an average weighted by exp(-distance / span), not a smoother that knows the tails.
void heading_errors(std::span<const double> above, std::span<const double> time, double span,
                    std::vector<double>& errors);

}  // namespace puckloop::gap
