#include "gap/findings/quantities.h"

#include "gap/kinds/columns.h"

#include <fmt/format.h>

#include <map>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr double kDegree = 57.29577951308232;
constexpr std::string_view kLogarithm = "ln ";  // a unit of logarithms begins so

}  // namespace

std::string plain_observable(const std::string& name) {
    constexpr std::string_view kOutliers = "outliers of ";
    static const std::map<std::string, const char*> kPlain{{"along", "distance along the heading"},
                                                           {"across", "distance across the heading"},
                                                           {"x_m", "position x"},
                                                           {"y_m", "position y"},
                                                           {"place", "position"}};
    if (name.starts_with(kOutliers))
        return std::string(kOutliers) + plain_observable(name.substr(kOutliers.size()));
    const auto known = kPlain.find(name);
    return known == kPlain.end() ? name : known->second;
}

std::string quantity(double value, const std::string& unit, int more_digits, double like) {
    const double size = std::abs(std::isnan(like) ? value : like);
    const int three = 3 + more_digits, four = 4 + more_digits;
    if (unit == "m" && size < 1) return fmt::format("{:.{}g} mm", value * 1e3, four);
    if (unit == "s" && size < 1) return fmt::format("{:.{}g} ms", value * 1e3, four);
    if (unit == "rad" && size < 7) return fmt::format("{:.{}g} deg", value * kDegree, three);
    if (unit.starts_with(kLogarithm)) return fmt::format("a factor of {:.{}g}", std::exp(value), four);
    if (unit == kShare) return fmt::format("{:.{}g} %", value * 100, three);
    if (unit == "1" && size < 0.2 && size > 0) return fmt::format("{:.{}g} %", value * 100, three);
    return fmt::format("{:.{}g}{}", value, four, unit_suffix(unit));
}

std::string change(double value, const std::string& unit) {
    const std::string size = quantity(value, unit, -1);
    return value < 0 || unit.starts_with(kLogarithm) ? size : "+" + size;
}

}  // namespace puckloop::gap
