#pragma once
// The revisions of the e-puck's main board that firmware can distinguish. Source: e-puck library,
// e_init_port.c and utility.c; e-puck fact sheet 3.13.

#include "base/enum_names.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace puckloop::pic {

enum class Revision {
    Rev12,  ///< up to 1.2: analogue accelerometer at AN5..AN7; of the battery only "low" (RF1)
    Rev13,  ///< from 1.3 on: LSM330 on the I2C bus; the battery's voltage at AN7
};

inline constexpr std::array<std::string_view, 2> kRevisionNames{"1.2", "1.3"};

constexpr std::string_view name_of(Revision revision) {
    return kRevisionNames[static_cast<std::size_t>(revision)];
}
constexpr std::optional<Revision> revision_of(std::string_view name) {
    return value_named<Revision>(kRevisionNames, name);
}

/// Counts at AN7 of revision 1.3: 2070 at 3.4 V, 2560 at 4.2 V (utility.c).
constexpr double battery_counts(double volts) {
    constexpr double kLowVolts = 3.4, kFullVolts = 4.2, kLowCounts = 2070, kFullCounts = 2560;
    return kLowCounts + (volts - kLowVolts) * (kFullCounts - kLowCounts) / (kFullVolts - kLowVolts);
}

}  // namespace puckloop::pic
