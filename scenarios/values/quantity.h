#pragma once
// Quantities as people write them in a scenario: a number and its unit, "60 s", "25 cm", "-45 deg".

#include <string>
#include <string_view>

namespace puckloop::scenarios {

/// What a quantity measures; each has one SI unit that the program computes with.
enum class Dimension {
    Time,
    Length,
    Angle,
    Mass,
    Frequency,
    Voltage,
    Force,
    Torque,
    Gain,      ///< dB
    Level,     ///< dBm
    DataRate,  ///< bit/s
    Ratio,
    Number
};

/// "a time, such as \"20 ms\"": for error messages.
std::string_view example_of(Dimension dimension);

/// Of a unit's name: "m", "rad", "kg", "s", "V", "N m", "Hz", "dB", "dBm", "bit/s" or "1"; others are bare
/// numbers.
Dimension dimension_of(std::string_view unit);

/// Thrown with the reason only; the caller knows file and line.
struct QuantityError {
    std::string problem;
    std::string expected;
};

/// Value in SI units (s, m, rad, kg, Hz, V, N, N m, dB, dBm, bit/s, 1). A unit is required except for Ratio
/// ("%", "ppm" or bare) and Number (bare). Throws QuantityError on a missing, unknown or wrong-dimension unit
/// and on malformed numbers.
double parse_quantity(std::string_view text, Dimension dimension);

}  // namespace puckloop::scenarios
