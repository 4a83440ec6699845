#pragma once
// A course of some quantity over time, as a fault's parameter has it: "0 s 4.1 V, 90 s 3.6 V".

#include "cosim/core/time.h"

#include <string_view>
#include <vector>

namespace puckloop::cosim {

struct ProfilePoint {
    Time time = 0;  ///< since the fault began
    double value = 0.0;

    friend bool operator==(const ProfilePoint&, const ProfilePoint&) = default;
};

/// Points of a voltage, parted by commas or semicolons: time (s, ms or min) and volts (V or mV), each with or
/// without its unit (s and V). At most 1000, with rising times up to 1e6 s; 0 to `most` volts. Throws
/// InputError.
std::vector<ProfilePoint> voltage_profile(std::string_view text, double most);

/// Straight lines between the points; before the first and after the last as there.
double value_at(const std::vector<ProfilePoint>& profile, Time time);

}  // namespace puckloop::cosim
