#pragma once
// What a verdict means for a run, as the file that `puckloop run --model` takes.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <string>

namespace puckloop::gap {

/// The overlay of a verdict's causes as TOML: [parameters] for `puckloop run --model`, [measurement] for what
/// belongs to the measuring chain.
std::string overlay_toml(const Experiment& experiment, const Verdict& verdict);

}  // namespace puckloop::gap
