#pragma once
// Whether a run's link faults leave what a snapshot holds as it is: known without any node.

#include "cosim/core/link.h"
#include "cosim/faults/faults.h"

#include <cstdint>
#include <vector>

namespace puckloop::cosim {

struct RunSnapshot;

/// Sends what was sent until the snapshot through the faults of `links`, the links of the run that was saved.
/// Throws InputError that names the link if that would have changed what arrived before the snapshot.
/// `seed`: of the run.
void check_link_faults(const RunSnapshot& from, const std::vector<LinkSpec>& links,
                       std::vector<FaultSpec> faults, std::uint64_t seed);

}  // namespace puckloop::cosim
