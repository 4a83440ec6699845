// The case "world" of `puckloop bench`.

#include "benchmark/case_kit.h"
#include "benchmark/speeds/world_cost.h"

#include <fmt/format.h>

namespace puckloop::tools {

void Kit::time_world() {
    for (const int robots : options_.robots) {
        std::vector<Figure> parts{
            {fmt::format("world, {} robots", robots), "us a robot and step", {}, {}, {}}};
        for (const std::string_view part : physics::kStepPartNames)
            parts.push_back(
                {fmt::format("world, {} robots, {}", robots, part), "us a robot and step", {}, {}, {}});
        for (int round = 0; round < options_.rounds; ++round) {
            add_reference(parts[0]);
            // About as long for many robots as for few.
            const WorldCost cost = measure_world({.robots = robots, .simulated_s = robots < 10 ? 5.0 : 2.0});
            parts[0].values.push_back(cost.total_us());
            for (std::size_t i = 0; i < physics::kStepParts; ++i)
                parts[i + 1].values.push_back(cost.part_us[i]);
        }
        figures_.insert(figures_.end(), parts.begin(), parts.end());
    }
}

}  // namespace puckloop::tools
