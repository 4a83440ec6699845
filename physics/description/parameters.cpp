// Parameters by name: look-up, range check, nearest name for a typing error.

#include "physics/description/parameters.h"

#include "base/text/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>
#include <stdexcept>

namespace puckloop::physics {

namespace {

const ParameterInfo& require(std::string_view name, int& index) {
    const auto* info = find_parameter(name, index);
    if (info == nullptr) {
        std::vector<std::string_view> names;
        for (const auto& one : parameter_table())
            names.emplace_back(one.name);
        throw std::invalid_argument(
            fmt::format("unknown parameter \"{}\"{}", name, did_you_mean(name, names)));
    }
    return *info;
}

}  // namespace

bool ParameterInfo::of_robot() const {
    const std::string_view text = name;
    return !text.starts_with("contact.") && !text.starts_with("world.");
}

const ParameterInfo* find_parameter(std::string_view name, int& index) {
    index = -1;
    for (const auto& info : parameter_table()) {
        const std::string_view base = info.name;
        if (name == base) return &info;
        if (info.count < 2 || !name.starts_with(base)) continue;
        const auto digits = name.substr(base.size());
        int number = -1;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const bool plain = digits.size() == 1 || (digits.size() == 2 && digits[0] != '0');
        if (error == std::errc() && end == digits.data() + digits.size() && plain && number >= 0 &&
            number < info.count) {
            index = number;
            return &info;
        }
    }
    return nullptr;
}

Parameters::Parameters() {
    for (const auto& info : parameter_table()) {
        double* first = info.place(*this);
        for (int i = 0; i < info.count; ++i)
            first[i] = info.defaults.size() == 1 ? info.defaults[0] : info.defaults[static_cast<size_t>(i)];
    }
}

void Parameters::set(std::string_view name, double value) {
    int index = -1;
    const auto& info = require(name, index);
    if (!std::isfinite(value) || value < info.min || value > info.max)
        throw std::invalid_argument(
            fmt::format("parameter {} = {} is out of range ({} to {}{})", name, value, info.min, info.max,
                        info.unit == std::string_view("1") ? "" : std::string(" ") + info.unit));
    double* first = info.place(*this);
    if (index >= 0)
        first[index] = value;
    else
        std::fill(first, first + info.count, value);
}

double Parameters::get(std::string_view name) const {
    int index = -1;
    const auto& info = require(name, index);
    Parameters copy = *this;
    return info.place(copy)[std::max(index, 0)];
}

}  // namespace puckloop::physics
