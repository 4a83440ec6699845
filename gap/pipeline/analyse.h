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

}  // namespace puckloop::gap
