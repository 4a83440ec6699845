#include "tools/run/parameter_list.h"

#include "physics/description/parameters.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace puckloop::tools {

void print_parameters() {
    fmt::print("{:32} {:10} {:24} {:24} {}\n", "name", "unit", "default", "range", "source");
    for (const physics::ParameterInfo& info : physics::parameter_table()) {
        const std::string name =
            info.count == 1 ? info.name : fmt::format("{}0..{}", info.name, info.count - 1);
        fmt::print("{:32} {:10} {:24} {:24} {}\n", name, info.unit,
                   fmt::format("{:g}", fmt::join(info.defaults, " ")),
                   fmt::format("{:g} .. {:g}", info.min, info.max), info.source);
    }
}

}  // namespace puckloop::tools
