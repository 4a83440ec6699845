#pragma once
// Terms without a mechanism: what a verdict on measured data learnt of a robot beyond every named cause
// (docs/gap.md), as tables over what the world knows. Each adds to one quantity, where that quantity enters.
//
// Deviations: 1. between two places of a table a straight line, beyond its ends the end. 2. What was learnt
// is a mean: of its uncertainty only the offset from run to run is drawn.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace puckloop::physics {

/// One side of a table.
struct ExtensionAxis {
    std::string over;        ///< a covariate's name
    std::vector<double> at;  ///< rising, SI units; two or more
};

/// `times` x (table + offset), added to a quantity.
struct ExtensionTerm {
    std::string adds_to;                ///< a quantity's name
    int sensor = -1;                    ///< of that quantity; -1: all of them
    std::string times{};                ///< a covariate that the table is a share of; empty: none
    std::vector<ExtensionAxis> over{};  ///< none, one or two
    std::vector<double> value{};        ///< the quantity's unit, over that of `times`; last axis fastest
    std::vector<double> sd{};           ///< of each value: how well it is known; read, and drawn nowhere
    double run_spread = 0.0;  ///< sd of an offset that each run and robot (and sensor) has for itself
};

/// What a table may depend on. Which of them a quantity knows stands with the quantity.
enum class Known : std::uint8_t {
    Speed,         ///< m/s ahead that the wheels ask for, mean of 0.1 s
    TurnRate,      ///< rad/s that they ask for, to the left, likewise
    Heading,       ///< rad, -pi to pi
    Time,          ///< s since power came
    Travelled,     ///< m that the wheels rolled, ahead or back
    Distance,      ///< m to what the sensor's middle ray meets; its reach where it meets nothing
    Angle,         ///< rad between that ray and the surface's normal
    Level,         ///< counts that the reading would be without the term
    Grey,          ///< of the floor under the sensor, 0 black to 1 white
    Battery,       ///< V
    Ambient,       ///< room light, 0 dark to 1 a lit room
    MotorSpeed,    ///< steps/s without sign, mean of both motors
    Acceleration,  ///< m/s2 ahead over the last 0.1 s
    Pitch,         ///< rad, nose up is positive
    Roll           ///< rad, left side up is positive
};
inline constexpr std::size_t kKnown = 15;
/// In the order of Known.
struct ExtensionCovariate {
    const char *name, *unit;
};
std::span<const ExtensionCovariate> extension_covariates();

/// What terms can add to.
enum class Extended : std::uint8_t {
    Forward,    ///< m/s over the floor while the wheels are driven
    Left,       ///< m/s
    Turn,       ///< rad/s, to the left
    Proximity,  ///< counts, before what is read is noisy and cut
    Ground,
    Microphone,
    AccelerationX,  ///< counts
    AccelerationY,
    AccelerationZ
};
inline constexpr std::size_t kExtended = 9;
/// In the order of Extended.
struct ExtendedQuantity {
    const char *name, *unit;
    int sensors;  ///< 1: there is only one
    double most;  ///< of a value's size: beyond, the data is no robot's
    std::vector<Known> knows;
};
std::span<const ExtendedQuantity> extended_quantities();

std::optional<Known> known_named(const std::string& name);
std::optional<Extended> extended_named(const std::string& name);

/// What is wrong with a term, and with which of its keys.
struct ExtensionProblem {
    std::string key, problem, expected;
};
/// The first problem; none: the term can be used.
std::optional<ExtensionProblem> problem_of(const ExtensionTerm& term);

}  // namespace puckloop::physics
