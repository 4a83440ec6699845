#pragma once
// Faults as a run would hand them to a board.

#include "cosim/faults/fault_json.h"

#include <string>

namespace puckloop::tests {

/// Fires whenever it can, from the run's begin to its end; to be narrowed by the caller.
inline cosim::FaultSpec board_fault(const std::string& kind, const std::string& name = "fault") {
    cosim::FaultSpec spec;
    spec.kind = kind;
    spec.name = name;
    spec.node = "board";
    return spec;
}

inline cosim::CarriedFault carried(const cosim::FaultSpec& spec, std::size_t index = 0) {
    return {spec, cosim::Trigger(spec, cosim::fault_stream(spec, 7, index))};
}

}  // namespace puckloop::tests
