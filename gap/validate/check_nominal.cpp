#include "gap/validate/checks.h"

#include "gap/kinds/columns.h"
#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

struct Limit {
    std::string_view name;
    double low, high;
    const char* wanted;
};

constexpr Limit kLimits[] = {
    {"firmware.agenda", 0.0, 1.0,
     "1: the original firmware's staircase of speeds, or 0: speeds as commanded"},
    {"firmware.start_loss", 0.0, 10.0, "0 to 10 steps"},
    {"inverse_friction", 0.0, 100.0, "0 (nothing slides) to 100"},
    {"contact.mu", 0.01, 100.0, "0.01 to 100"},
    {"wheel_scale", -0.5, 1.0, "-0.5 to 1"},
    {"wheel_mismatch", -0.5, 0.5, "-0.5 to 0.5"},
};
constexpr double kFarOff = 10.0;  // times the ends of what a scenario takes

void check_limit(const Experiment& experiment, const Limit& limit, double value) {
    const bool whole = limit.name != "firmware.agenda" || value == std::round(value);
    if (value >= limit.low && value <= limit.high && whole) return;
    refuse(experiment, fmt::format("[nominal] {} = {:g} is not possible", limit.name, value), limit.wanted);
}

}  // namespace

void check_nominal(Experiment& experiment) {
    for (const auto& [name, value] : experiment.nominal) {
        for (const Limit& limit : kLimits)
            if (name == limit.name) check_limit(experiment, limit, value);
        int index = -1;
        const physics::ParameterInfo* info = physics::find_parameter(name, index);
        if (info == nullptr) continue;
        if (info->min > 0 && value <= 0)
            refuse(experiment, fmt::format("[nominal] {} = {:g} is not possible", name, value),
                   "more than 0");
        const double most = kFarOff * std::max(std::abs(info->min), std::abs(info->max));
        const bool small = info->min > 0 && value * kFarOff < info->min;
        if (std::abs(value) <= most && !small) continue;
        experiment.caution("[nominal] {} = {:g}{} is far from {:g} to {:g}, which the "
                           "simulator's robot can have: is the unit right?",
                           name, value, unit_suffix(info->unit), info->min, info->max);
    }
}

}  // namespace puckloop::gap
