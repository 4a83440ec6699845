#pragma once
// Runs of a drawn scenario in which no node may break what it has stated of its future (cosim/core/node.h):
// its earliest output time and its lookahead. The conductor checks every message.

#include "cosim/core/time.h"
#include "tests/end_to_end/kit/workbench.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tests {

/// How a run is executed, which changes nothing in its trace.
struct Way {
    std::uint64_t chop = 0;                ///< grants are cut at random places, by this seed; 0: they are not
    unsigned threads = 1;                  ///< of one process
    bool windows = false;                  ///< nothing runs ahead
    bool process_per_node = false;         ///< `threads` is 1 then
    std::optional<cosim::Time> from = {};  ///< goes on from a snapshot of that instant
};

struct Conducted {
    bool failed = false;  ///< the run broke off
    std::string why;
    std::string trace_sha256;
};

/// `name` is that of the results' folder. Throws InputError for a scenario that is refused.
Conducted conduct(const Workbench& bench, const std::filesystem::path& scenario, double seconds,
                  const std::string& name, const Way& way);

/// When the scenario's faults begin.
std::vector<cosim::Time> begins_of_faults(const std::filesystem::path& scenario);

}  // namespace puckloop::tests
