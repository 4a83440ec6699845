#pragma once
// Pulses of other robots' emitters, as repeats at one place show them: readings that jump.

#include "gap/models/model.h"
#include "physics/description/parameters.h"

#include <array>
#include <vector>

namespace puckloop::gap {

struct ForeignPulses {
    double size = 0.0;                                         ///< counts, usual jump; 0: none jumps
    std::array<bool, physics::kProximitySensors> sheltered{};  ///< a foreign source does not hit this sensor
};

/// Sheltered are all but an arc of the ring whose repeats jump clearly more often than the others'; where no
/// arc does, none is. `sensor`, `distance` (m) and `angle` (rad) are those of the readings' rows.
ForeignPulses foreign_pulses(const Observable& readings, const std::vector<int>& sensor,
                             const std::vector<double>& distance, const std::vector<double>& angle);

}  // namespace puckloop::gap
