#include "physics/description/extension.h"

#include "physics/description/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace puckloop::physics {

namespace {

constexpr std::size_t kMostPlaces = 200;  // of an axis
constexpr double kFastest = 1.0;          // m/s: several times what an e-puck drives
constexpr double kFastestTurn = 30.0;     // rad/s, likewise
constexpr double kMostCounts = 1e5;       // several times what any converter here gives

using enum Known;

const std::vector<ExtendedQuantity>& quantities() {
    static const std::vector<Known> drive{Speed, TurnRate, Heading, Time, Travelled, Battery},
        tilt{Pitch, Roll, Time, Battery, MotorSpeed, Speed, Level};
    static const std::vector<ExtendedQuantity> all{
        {"motion.forward", "m/s", 1, kFastest, drive},
        {"motion.left", "m/s", 1, kFastest, drive},
        {"motion.turn", "rad/s", 1, kFastestTurn, drive},
        {"proximity.reading",
         "counts",
         kProximitySensors,
         kMostCounts,
         {Distance, Angle, Level, Time, Battery, Ambient, MotorSpeed}},
        {"ground.reading",
         "counts",
         kGroundSensors,
         kMostCounts,
         {Grey, Level, Time, Battery, Ambient, MotorSpeed, Speed, Acceleration, Pitch}},
        {"microphone.level", "counts", kMicrophones, kMostCounts, {Level, Time, Battery, MotorSpeed}},
        {"accelerometer.x", "counts", 1, kMostCounts, tilt},
        {"accelerometer.y", "counts", 1, kMostCounts, tilt},
        {"accelerometer.z", "counts", 1, kMostCounts, tilt}};
    return all;
}

constexpr std::array<ExtensionCovariate, kKnown> kCovariates{{{"speed", "m/s"},
                                                              {"turn_rate", "rad/s"},
                                                              {"heading", "rad"},
                                                              {"time", "s"},
                                                              {"travelled", "m"},
                                                              {"distance", "m"},
                                                              {"angle", "rad"},
                                                              {"level", "counts"},
                                                              {"grey", "1"},
                                                              {"battery", "V"},
                                                              {"ambient", "1"},
                                                              {"motor_speed", "steps/s"},
                                                              {"acceleration", "m/s2"},
                                                              {"pitch", "rad"},
                                                              {"roll", "rad"}}};

template <class All>
std::string names_of(const All& all) {
    std::vector<std::string> names;
    for (const auto& one : all)
        names.emplace_back(one.name);
    return fmt::format("{}", fmt::join(names, ", "));
}

std::string names_known(const ExtendedQuantity& quantity) {
    std::vector<std::string> names;
    for (const Known one : quantity.knows)
        names.emplace_back(kCovariates[static_cast<std::size_t>(one)].name);
    return fmt::format("{}", fmt::join(names, ", "));
}

bool knows(const ExtendedQuantity& quantity, const std::string& name) {
    const auto known = known_named(name);
    return known && std::ranges::find(quantity.knows, *known) != quantity.knows.end();
}

std::optional<ExtensionProblem> problem_of(const ExtensionAxis& axis, const ExtendedQuantity& quantity) {
    if (!knows(quantity, axis.over))
        return ExtensionProblem{"over", fmt::format("{} does not know '{}'", quantity.name, axis.over),
                                "of " + names_known(quantity)};
    if (axis.at.size() < 2 || axis.at.size() > kMostPlaces)
        return ExtensionProblem{"at", fmt::format("{} places along {}", axis.at.size(), axis.over),
                                fmt::format("2 to {}", kMostPlaces)};
    const auto finite = [](double one) { return std::isfinite(one); };
    if (!std::ranges::all_of(axis.at, finite) ||
        std::ranges::adjacent_find(axis.at, std::greater_equal<>()) != axis.at.end())
        return ExtensionProblem{"at", fmt::format("the places along {} do not rise", axis.over),
                                "each above the one before"};
    return std::nullopt;
}

std::optional<ExtensionProblem> problem_of_values(const ExtensionTerm& term,
                                                  const ExtendedQuantity& quantity) {
    std::size_t places = 1;
    for (const ExtensionAxis& axis : term.over)
        places *= axis.at.size();
    if (term.value.size() != places)
        return ExtensionProblem{"value", fmt::format("{} values of a table of {}", term.value.size(), places),
                                "one value per place, the last axis fastest"};
    for (const double one : term.value)
        if (!(std::abs(one) <= quantity.most))
            return ExtensionProblem{"value", fmt::format("{} {} is out of range", one, quantity.unit),
                                    fmt::format("-{0} to {0} {1}", quantity.most, quantity.unit)};
    if (!term.sd.empty() && term.sd.size() != places)
        return ExtensionProblem{"sd", fmt::format("{} values beside {}", term.sd.size(), places),
                                "as many as of value, or none"};
    if (std::ranges::any_of(term.sd, [&](double one) { return !(one >= 0 && one <= quantity.most); }))
        return ExtensionProblem{"sd", "a standard deviation is out of range",
                                fmt::format("0 to {} {}", quantity.most, quantity.unit)};
    if (!(term.run_spread >= 0 && term.run_spread <= quantity.most))
        return ExtensionProblem{"run_spread", "run_spread is out of range",
                                fmt::format("0 to {} {}", quantity.most, quantity.unit)};
    return std::nullopt;
}

template <class All>
auto index_named(const All& all, const std::string& name) {
    const auto found = std::ranges::find_if(all, [&](const auto& one) { return name == one.name; });
    return found == all.end() ? std::optional<std::size_t>() : static_cast<std::size_t>(found - all.begin());
}

}  // namespace

std::span<const ExtensionCovariate> extension_covariates() {
    return kCovariates;
}

std::span<const ExtendedQuantity> extended_quantities() {
    return quantities();
}

std::optional<Known> known_named(const std::string& name) {
    const auto index = index_named(kCovariates, name);
    return index ? std::optional(static_cast<Known>(*index)) : std::nullopt;
}

std::optional<Extended> extended_named(const std::string& name) {
    const auto index = index_named(quantities(), name);
    return index ? std::optional(static_cast<Extended>(*index)) : std::nullopt;
}

std::optional<ExtensionProblem> problem_of(const ExtensionTerm& term) {
    const auto extended = extended_named(term.adds_to);
    if (!extended)
        return ExtensionProblem{"adds_to", fmt::format("unknown quantity '{}'", term.adds_to),
                                "one of " + names_of(quantities())};
    const ExtendedQuantity& quantity = quantities()[static_cast<std::size_t>(*extended)];
    if (term.sensor < -1 || term.sensor >= quantity.sensors)
        return ExtensionProblem{"sensor", fmt::format("{} has no sensor {}", quantity.name, term.sensor),
                                fmt::format("0 to {}, or none for all", quantity.sensors - 1)};
    if (!term.times.empty() && !knows(quantity, term.times))
        return ExtensionProblem{"times", fmt::format("{} does not know '{}'", quantity.name, term.times),
                                "of " + names_known(quantity)};
    if (term.over.size() > 2)
        return ExtensionProblem{"over", fmt::format("a table over {} covariates", term.over.size()),
                                "two at most"};
    for (const ExtensionAxis& axis : term.over)
        if (auto problem = problem_of(axis, quantity)) return problem;
    if (term.over.size() == 2 && term.over[0].over == term.over[1].over)
        return ExtensionProblem{"over", fmt::format("{} is there twice", term.over[0].over),
                                "two different covariates"};
    return problem_of_values(term, quantity);
}

}  // namespace puckloop::physics
