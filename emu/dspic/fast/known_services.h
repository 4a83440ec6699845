#pragma once
// What is known of one machine's interrupt service routines, by vector; filled as they are met.

#include "emu/dspic/fast/isr_path.h"
#include "emu/dspic/fast/isr_summary.h"

#include <optional>
#include <vector>

namespace puckloop::dspic {

struct KnownServices {
    std::vector<std::optional<IsrSummary>> summaries;
    std::vector<IsrPaths> paths;
};

}  // namespace puckloop::dspic
