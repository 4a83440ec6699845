#pragma once
// A fault that the run has given to a node to carry out, as the node's description has it.

#include "base/fields/json_value.h"
#include "cosim/faults/fault_json.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::cosim {

struct NodeFault {
    FaultSpec spec{};
    std::uint64_t seed = 1;  ///< the run's
    std::size_t index = 0;   ///< the fault's place in the run's list: which random stream is its own
};

JsonValue to_value(const NodeFault& fault);
/// Throws InputError for what is no list of faults.
std::vector<NodeFault> node_faults(const JsonValue& list);

/// Each with its trigger, as the node begins.
std::vector<CarriedFault> carried(const std::vector<NodeFault>& faults);

}  // namespace puckloop::cosim
