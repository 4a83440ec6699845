#include "scenarios/reader/compose/spread.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <vector>

namespace puckloop::scenarios {

namespace {

std::string_view trimmed_item(std::string_view text) {
    while (!text.empty() && text.front() == ' ')
        text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    return text;
}

struct Quantity {
    double value = 0.0;
    std::string_view unit;
};

Quantity quantity_of(std::string_view text) {
    Quantity quantity;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), quantity.value);
    if (error != std::errc{} || !std::isfinite(quantity.value))
        throw SpreadError{fmt::format("'{}' is not a number", text), "\"normal(0, 15 ppm)\""};
    quantity.unit = trimmed_item({end, static_cast<std::size_t>(text.data() + text.size() - end)});
    return quantity;
}

std::vector<std::string_view> split_list(std::string_view list) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto comma = list.find(',');
        parts.push_back(trimmed_item(list.substr(0, comma)));
        if (comma == std::string_view::npos) return parts;
        list.remove_prefix(comma + 1);
    }
}

TomlValue with_unit(double value, std::string_view unit) {
    TomlValue result;
    if (unit.empty())
        result.data = value;
    else
        result.data = fmt::format("{:.9g} {}", value, unit);
    return result;
}

TomlValue chosen(std::string_view text) {
    TomlValue result;
    std::int64_t whole = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
    if (error == std::errc{} && end == text.data() + text.size())
        result.data = whole;
    else
        result.data = std::string(text);
    return result;
}

}  // namespace

std::optional<TomlValue> drawn(std::string_view text, RandomStream& random) {
    const auto open = text.find('(');
    if (open == std::string_view::npos || text.back() != ')') return std::nullopt;
    const std::string_view name = text.substr(0, open);
    const bool normal = name == "normal", uniform = name == "uniform";
    if (!normal && !uniform && name != "choice") return std::nullopt;
    const auto parts = split_list(text.substr(open + 1, text.size() - open - 2));
    if (!normal && !uniform) {
        if (parts.front().empty())
            throw SpreadError{"choice() has nothing to choose from", "\"choice(1, 2)\""};
        return chosen(parts[random.below(parts.size())]);
    }
    if (parts.size() != 2)
        throw SpreadError{fmt::format("'{}' has {} values", text, parts.size()),
                          normal ? "\"normal(MEAN, DEVIATION)\"" : "\"uniform(LEAST, LARGEST)\""};
    Quantity first = quantity_of(parts[0]), second = quantity_of(parts[1]);
    if (first.unit.empty() && first.value == 0.0) first.unit = second.unit;
    if (second.unit.empty() && second.value == 0.0) second.unit = first.unit;
    if (first.unit != second.unit)
        throw SpreadError{fmt::format("'{}' has two units", text), "both values in the same unit"};
    if (normal && second.value < 0.0)
        throw SpreadError{fmt::format("'{}' has a deviation below 0", text), "\"normal(MEAN, DEVIATION)\""};
    if (uniform && second.value < first.value)
        throw SpreadError{fmt::format("'{}' ends before it begins", text), "\"uniform(LEAST, LARGEST)\""};
    const double value = normal ? first.value + second.value * random.normal()
                                : first.value + (second.value - first.value) * random.uniform();
    return with_unit(value, first.unit);
}

}  // namespace puckloop::scenarios
