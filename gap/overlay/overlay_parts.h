#pragma once
// What a verdict means for a run where the two do not have the same parameter: links, clocks and Linux
// boards; the infra-red medium; sensors.

#include "gap/data/experiment.h"

#include <map>
#include <optional>
#include <string>

namespace puckloop::gap {

/// Parameters by name.
using Values = std::map<std::string, double>;

struct Extension;

/// A fitted number, taken out where it is there.
std::optional<double> take(Values& fitted, const std::string& name);

/// The learnt tables as [[extension]] tables; empty where a run takes none of it.
std::string extension_toml(const Extension& extension);

/// Does an overlay hand a forward model's parameter on to a run, under [parameters], [uart], [linux] or
/// [clock]? The others stand under [measurement], which a run passes over.
bool overlay_takes(const std::string& parameter);

/// [uart], [linux] and [clock]. Takes those parameters out of `fitted` that a run has there, written as TOML
/// tables; `nominal` is what the experiment says of its robot. What would make a frame faster than the
/// simulator's stays.
std::string links_overlay(const Values& nominal, Values& fitted);

/// Takes the parameters of the strength, bearing and loss out of `fitted` and sets the medium's (`ir.*`) in
/// `simulator` so that a board reports what they say. What the medium has nothing for stays in `fitted`.
void rab_overlay(Values& fitted, Values& simulator);

/// Takes what it knows out of `fitted` and sets the world's parameters in `simulator`:
/// - an age or lag, less what firmware and host make by themselves, which an emulated run makes again;
/// - the accelerometer's zeros of the sessions: their mean as bias, their spread for each run to draw from;
/// - the sensors that foreign pulses do not reach;
/// - where in a series of runs a drift between them leaves the simulator right.
void sensors_overlay(const Experiment& experiment, Values& fitted, Values& simulator);

/// Parameters whose number in [nominal] is the share of firmware and host: true of the emulator, too, and no
/// parameter of its world.
bool made_by_firmware(const std::string& parameter);

}  // namespace puckloop::gap
