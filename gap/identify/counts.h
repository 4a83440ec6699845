#pragma once
// What a drive's counters, or commands, can say: a number by which counts are multiplied is fitted too small,
// however sure it seems, where the counts themselves err. Here a cause is asked again beside counters that
// may err, wheels that may slip and a tracker that may miss, each by as much as the drive itself shows.

#include "gap/fit/study.h"
#include "gap/identify/drive_filter.h"

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace puckloop::gap {

/// Effects of a fit that these drives cannot identify, and why, in words that follow "but".
struct NotIdentified {
    std::vector<std::size_t> effects;
    std::string why;
};

/// The drive as counters and tracker have it: `without` is the fit with these effects back at neutral.
/// Nothing where no wheel was counted or commanded.
CountedDrive drive_of(const Study& study, const Fit& fit, std::span<const std::size_t> effects);

/// Causes of a drive that do no more than counters that err, or whose numbers are others beside such
/// counters.
NotIdentified not_by_counts(const Study& study, const Fit& fit);

}  // namespace puckloop::gap
