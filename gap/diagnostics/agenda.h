#pragma once
// Which speeds does this robot make of its commands? The original firmware's agenda makes a staircase of them
// (600 steps/s become 625), other robots keep to them. Told wrongly, wheels and commands are blamed for it.

#include "gap/data/experiment.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// A caution where commanded drives fit the other kind of motor driver beyond doubt, whatever the wheels'
/// size and distance are and with the `effects` (names) that were found; else "". Nothing is changed: what
/// drives a robot is for its owner to say.
std::string agenda_caution(const Experiment& experiment, const std::vector<std::string>& effects,
                           std::uint64_t seed, unsigned threads);

}  // namespace puckloop::gap
