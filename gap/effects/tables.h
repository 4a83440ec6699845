#pragma once
// The catalogue's tables, one a kind of experiment; catalogue.cpp puts them in order. An effect that acts in
// several kinds stands in the first of them. Above each: its mechanism and equation.

#include "gap/effects/effect.h"

namespace puckloop::gap {

std::vector<Effect> motion_effects();
std::vector<Effect> proximity_effects();
std::vector<Effect> ground_effects();
std::vector<Effect> accelerometer_effects();
std::vector<Effect> microphone_effects();
std::vector<Effect> rab_effects();
std::vector<Effect> timing_effects();

}  // namespace puckloop::gap
