#pragma once
// The catalogue: effects of all kinds of experiment, as tables.

#include "gap/kinds/effect.h"

#include <span>
#include <vector>

namespace puckloop::gap {

/// Tables of the catalogue. An effect that acts in several kinds stands in the first of them. Above each: its
/// mechanism and equation.
std::vector<Effect> motion_effects();
std::vector<Effect> proximity_effects();
std::vector<Effect> ground_effects();
std::vector<Effect> accelerometer_effects();
std::vector<Effect> microphone_effects();
std::vector<Effect> rab_effects();
std::vector<Effect> timing_effects();

/// All of them, in the order of the sheet.
std::span<const Effect> catalogue();
/// Of a built-in kind those of the catalogue; of a described one its own, which live as long as its
/// description.
std::vector<const Effect*> effects_of(const Kind& kind);

}  // namespace puckloop::gap
