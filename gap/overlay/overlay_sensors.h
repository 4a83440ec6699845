#pragma once
// What a verdict on sensors means for the world model where the two do not have the same parameter.

#include "gap/data/experiment.h"

#include <map>
#include <string>

namespace puckloop::gap {

/// Takes what it knows out of `fitted` and sets the world's parameters in `simulator`:
/// - an age or lag, less what firmware and host make by themselves, which an emulated run makes again;
/// - the accelerometer's zeros of the sessions: their mean as bias, their spread for each run to draw from;
/// - the sensors that foreign pulses do not reach;
/// - where in a series of runs a drift between them leaves the simulator right.
void sensors_overlay(const Experiment& experiment, std::map<std::string, double>& fitted,
                     std::map<std::string, double>& simulator);

/// Parameters whose number in [nominal] is the share of firmware and host: true of the emulator, too, and no
/// parameter of its world.
bool made_by_firmware(const std::string& parameter);

}  // namespace puckloop::gap
