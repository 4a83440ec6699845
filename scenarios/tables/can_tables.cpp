#include "scenarios/tables/can_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::scenarios {

namespace {

/// Every CAN module that a scenario's boards have.
std::vector<CanController> all_controllers(const Scenario& scenario) {
    std::vector<CanController> all;
    for (const RobotBoards& robot : scenario.robots)
        for (const int unit : {1, 2}) {
            all.push_back({robot.name + ".pic", unit});
            if (robot.rab) all.push_back({robot.name + ".rab", unit});
        }
    std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.name() < b.name(); });
    return all;
}

/// Of the nodes that a run has without CAN.
bool is_taken(const Scenario& scenario, const std::string& name) {
    const std::set<std::string> fixed{"world", "ir", "ircom", "ether", "bluetooth", "coordinator", "network"};
    const auto has = [&](const auto& list) {
        return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
    };
    return fixed.contains(name) || has(scenario.robots) || has(scenario.tams) || has(scenario.can_buses);
}

std::string read_name(Reader& reader, const Scenario& scenario) {
    const std::size_t index = scenario.can_buses.size();
    std::string name = reader.text("name", index == 0 ? "can" : fmt::format("can{}", index));
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-';
    });
    if (!plain)
        reader.fail("name", fmt::format("'{}' is no name for a bus", name), "letters, digits, '_' and '-'");
    if (is_taken(scenario, name))
        reader.fail("name", fmt::format("something else has the name '{}'", name), "another name");
    return name;
}

}  // namespace

void read_can_buses(Reader& top, Scenario& scenario) {
    const std::vector<CanController> all = all_controllers(scenario);
    std::set<std::string> wired;
    for (const TomlValue* table : top.tables("can_bus")) {
        Reader reader(top.file(), fmt::format("can_bus {}", scenario.can_buses.size() + 1), *table);
        CanBus bus;
        bus.name = read_name(reader, scenario);
        for (const std::string& name : reader.texts("controllers")) {
            const auto found =
                std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name() == name; });
            if (found == all.end()) {
                std::vector<std::string> known;
                for (const CanController& one : all)
                    known.push_back(one.name());
                reader.fail("controllers", fmt::format("there is no CAN controller '{}'", name),
                            known.empty() ? "a robot, whose boards have some"
                                          : fmt::format("{}", fmt::join(known, ", ")));
            }
            if (!wired.insert(name).second)
                reader.fail("controllers", fmt::format("'{}' is on a bus already", name),
                            "each controller once");
            bus.controllers.push_back(*found);
        }
        constexpr std::size_t kMost = 110;  // nodes that the usual transceivers can drive
        if (bus.controllers.empty() || bus.controllers.size() > kMost)
            reader.fail("controllers", fmt::format("{} controllers on a bus", bus.controllers.size()),
                        "1 to 110, such as [\"robot0.pic.can1\", \"robot1.pic.can1\"]");
        reader.finish();
        scenario.can_buses.push_back(std::move(bus));
    }
}

}  // namespace puckloop::scenarios
