#pragma once
// The one entry: experiment in, verdict out.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <functional>
#include <string>

namespace puckloop::gap {

struct Options {
    std::uint64_t seed = 1;
    unsigned threads = 1;  ///< the verdict is the same for any number
    /// What is being done and how far (0..1); may be empty.
    std::function<void(const std::string&, double)> progress = nullptr;
    bool ask_all = false;  ///< also what no longer changes the verdict, so that each rule's worth is known
};

Verdict analyse(const Experiment& experiment, const Options& options = {});

/// The overlay of a verdict's causes as TOML: [parameters] for `puckloop run --model`, [measurement] for what
/// belongs to the measuring chain.
std::string overlay_toml(const Experiment& experiment, const Verdict& verdict);

}  // namespace puckloop::gap
