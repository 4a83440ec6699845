#pragma once
// The pictures of a report: what was measured, what the simulator said before and after, what is left.

#include "gap/data/experiment.h"
#include "gap/verdict/verdict.h"

#include <string>
#include <vector>

namespace puckloop::gap::report {

struct Picture {
    std::string svg, caption;
};

/// Colours of measured, simulated before, simulated after: told apart in black-and-white print too.
inline constexpr const char* kMeasured = "#777777";
inline constexpr const char* kBefore = "#1f6fb4";
inline constexpr const char* kAfter = "#d9540b";

/// Of one observable: measured and simulated against what matters most, residuals with bootstrap bands,
/// residuals by run, and against the covariate with the clearest structure.
std::vector<Picture> pictures_of(const Experiment& experiment, const Series& series, std::uint64_t seed);

/// Tracked paths of some runs with the simulated ones (kind motion; empty otherwise).
std::vector<Picture> path_pictures(const Experiment& experiment, const Verdict& verdict);

/// Held-out error after over before, one mark an observable, with 90 % intervals.
Picture gain_picture(const Verdict& verdict);

}  // namespace puckloop::gap::report
