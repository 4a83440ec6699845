#include "scenarios/values/quantity.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

namespace puckloop::scenarios {

namespace {

struct QuantityUnit {
    std::string_view name;
    Dimension dimension;
    double si;  ///< one of it, in the SI unit
};

constexpr std::array kUnits{
    QuantityUnit{"s", Dimension::Time, 1.0},
    QuantityUnit{"ms", Dimension::Time, 1e-3},
    QuantityUnit{"us", Dimension::Time, 1e-6},
    QuantityUnit{"min", Dimension::Time, 60.0},
    QuantityUnit{"h", Dimension::Time, 3600.0},
    QuantityUnit{"m", Dimension::Length, 1.0},
    QuantityUnit{"cm", Dimension::Length, 1e-2},
    QuantityUnit{"mm", Dimension::Length, 1e-3},
    QuantityUnit{"rad", Dimension::Angle, 1.0},
    QuantityUnit{"deg", Dimension::Angle, std::numbers::pi / 180.0},
    QuantityUnit{"kg", Dimension::Mass, 1.0},
    QuantityUnit{"g", Dimension::Mass, 1e-3},
    QuantityUnit{"Hz", Dimension::Frequency, 1.0},
    QuantityUnit{"kHz", Dimension::Frequency, 1e3},
    QuantityUnit{"MHz", Dimension::Frequency, 1e6},
    QuantityUnit{"V", Dimension::Voltage, 1.0},
    QuantityUnit{"mV", Dimension::Voltage, 1e-3},
    QuantityUnit{"N", Dimension::Force, 1.0},
    QuantityUnit{"Nm", Dimension::Torque, 1.0},
    QuantityUnit{"mNm", Dimension::Torque, 1e-3},
    QuantityUnit{"dB", Dimension::Gain, 1.0},
    QuantityUnit{"dBm", Dimension::Level, 1.0},
    QuantityUnit{"bit/s", Dimension::DataRate, 1.0},
    QuantityUnit{"kbit/s", Dimension::DataRate, 1e3},
    QuantityUnit{"Mbit/s", Dimension::DataRate, 1e6},
    QuantityUnit{"Gbit/s", Dimension::DataRate, 1e9},
    QuantityUnit{"%", Dimension::Ratio, 1e-2},
    QuantityUnit{"ppm", Dimension::Ratio, 1e-6},
};

struct DimensionText {
    std::string_view noun;
    std::string_view example;
};

DimensionText text_of(Dimension dimension) {
    switch (dimension) {
    case Dimension::Time:
        return {"a time", "a time such as \"20 ms\""};
    case Dimension::Length:
        return {"a length", "a length such as \"25 cm\""};
    case Dimension::Angle:
        return {"an angle", "an angle such as \"45 deg\""};
    case Dimension::Mass:
        return {"a mass", "a mass such as \"150 g\""};
    case Dimension::Frequency:
        return {"a frequency", "a frequency such as \"7.3728 MHz\""};
    case Dimension::Voltage:
        return {"a voltage", "a voltage such as \"3.7 V\""};
    case Dimension::Force:
        return {"a force", "a force such as \"1.5 N\""};
    case Dimension::Torque:
        return {"a torque", "a torque such as \"20 mNm\""};
    case Dimension::Gain:
        return {"a ratio of powers", "a ratio of powers such as \"3 dB\""};
    case Dimension::Level:
        return {"a power", "a power such as \"-82 dBm\""};
    case Dimension::DataRate:
        return {"a rate", "a rate such as \"11 Mbit/s\""};
    case Dimension::Ratio:
        return {"a ratio", "a ratio such as 0.5, \"50 %\" or \"20 ppm\""};
    case Dimension::Number:
        return {"a number", "a plain number such as 0.5"};
    }
    return {};
}

std::string units_of(Dimension dimension) {
    std::string list;
    for (const QuantityUnit& unit : kUnits)
        if (unit.dimension == dimension) list += fmt::format("{}{}", list.empty() ? "" : ", ", unit.name);
    return list;
}

}  // namespace

std::string_view example_of(Dimension dimension) {
    return text_of(dimension).example;
}

double parse_quantity(std::string_view text, Dimension dimension) {
    const std::string expected(example_of(dimension));
    const auto trim = [](std::string_view s) {
        while (!s.empty() && s.front() == ' ')
            s.remove_prefix(1);
        while (!s.empty() && s.back() == ' ')
            s.remove_suffix(1);
        return s;
    };
    std::string_view rest = trim(text);
    if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    if (error != std::errc{} || !std::isfinite(value))
        throw QuantityError{fmt::format("'{}' does not begin with a number", text), expected};
    const std::string_view unit_name = trim(rest.substr(static_cast<std::size_t>(end - rest.data())));
    if (unit_name.empty()) {
        if (dimension == Dimension::Ratio || dimension == Dimension::Number) return value;
        throw QuantityError{fmt::format("'{}' has no unit", text), expected};
    }
    for (const QuantityUnit& unit : kUnits) {
        if (unit.name != unit_name) continue;
        if (unit.dimension == dimension) return value * unit.si;
        throw QuantityError{fmt::format("'{}' is {}", text, text_of(unit.dimension).noun), expected};
    }
    if (dimension == Dimension::Number)
        throw QuantityError{fmt::format("'{}' has a unit where none belongs", text), expected};
    throw QuantityError{fmt::format("unknown unit '{}'", unit_name), "one of " + units_of(dimension)};
}

Dimension dimension_of(std::string_view unit) {
    if (unit == "m") return Dimension::Length;
    if (unit == "rad") return Dimension::Angle;
    if (unit == "kg") return Dimension::Mass;
    if (unit == "s") return Dimension::Time;
    if (unit == "V") return Dimension::Voltage;
    if (unit == "N m") return Dimension::Torque;
    if (unit == "Hz") return Dimension::Frequency;
    if (unit == "dB") return Dimension::Gain;
    if (unit == "dBm") return Dimension::Level;
    if (unit == "bit/s") return Dimension::DataRate;
    if (unit == "1") return Dimension::Ratio;
    return Dimension::Number;  // counts, steps and the like: bare numbers
}

}  // namespace puckloop::scenarios
