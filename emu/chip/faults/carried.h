#pragma once
// Faults that a board carries out, as part of its state.

#include "base/states/archive.h"
#include "cosim/faults/fault_json.h"

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace puckloop::chip {

/// In a saved state by name, so that a run with other faults can go on from it.
template <class Archive>
void list_faults(Archive& archive, std::vector<cosim::CarriedFault>& faults) {
    if constexpr (Archive::kRaw) {
        archive.fixed(faults);
    } else {
        std::map<std::string, std::vector<std::uint8_t>> kept;
        if constexpr (!Archive::kLoads)
            for (cosim::CarriedFault& fault : faults) {
                StateWriter writer(kept[fault.spec.name]);
                writer(fault);
            }
        archive(kept);
        if constexpr (Archive::kLoads)
            for (cosim::CarriedFault& fault : faults)
                if (const auto found = kept.find(fault.spec.name); found != kept.end()) {
                    StateReader reader(found->second);
                    reader(fault);
                    reader.end();
                }
    }
}

}  // namespace puckloop::chip
