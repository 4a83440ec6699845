#include "run/plan/parameter_list.h"

#include "physics/description/description.h"
#include "physics/description/parameters.h"
#include "physics/description/robot_parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string>

namespace puckloop::tools {

namespace {

using physics::ParameterInfo;
using physics::Parameters;

/// As defaults are given: one value for all of an array, or each.
std::string values_of(const ParameterInfo& info, Parameters& parameters) {
    std::span<const double> values(info.place(parameters), static_cast<std::size_t>(info.count));
    const bool all_alike = std::equal(values.begin() + 1, values.end(), values.begin());
    if (all_alike) values = values.first(1);
    return fmt::format("{:g}", fmt::join(values, " "));
}

void print_row(const std::string& name, const char* unit, const std::string& value, const std::string& range,
               const char* source, const std::string* in_force) {
    fmt::print("{:32} {:10} {:24} ", name, unit, value);
    if (in_force != nullptr) fmt::print("{:24} ", *in_force);
    fmt::print("{:24} {}\n", range, source);
}

}  // namespace

void print_parameters(const physics::World* world) {
    const std::string value = "value";
    print_row("name", "unit", "default", "range", "source", world != nullptr ? &value : nullptr);
    Parameters of_all = world != nullptr ? physics::with({}, world->parameters) : Parameters();
    for (const ParameterInfo& info : physics::parameter_table()) {
        const std::string name =
            info.count == 1 ? info.name : fmt::format("{}0..{}", info.name, info.count - 1);
        const std::string in_force = values_of(info, of_all);
        print_row(name, info.unit, fmt::format("{:g}", fmt::join(info.defaults, " ")),
                  fmt::format("{:g} .. {:g}", info.min, info.max), info.source,
                  world != nullptr ? &in_force : nullptr);
        if (world == nullptr) continue;
        for (const physics::Robot& robot : world->robots) {
            Parameters parameters = physics::parameters_of(*world, robot);
            const std::string own = values_of(info, parameters);
            if (own != in_force) print_row(name, info.unit, "", "", ("of " + robot.name).c_str(), &own);
        }
    }
}

}  // namespace puckloop::tools
