#include "run/driven/possible_actions.h"

#include "base/json.h"
#include "physics/description/parameters.h"
#include "physics/events/new_thing.h"
#include "physics/robot/tuning.h"
#include "scenarios/reader/events/action_forms.h"

#include <span>
#include <string>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

ordered_json names_of(std::span<const scenarios::ActionKey> keys) {
    ordered_json names = ordered_json::array();
    for (const scenarios::ActionKey& key : keys)
        names.push_back(std::string(key.name));
    return names;
}

}  // namespace

ordered_json possible_actions(const scenarios::Scenario& scenario) {
    ordered_json actions = ordered_json::array(), things = ordered_json::array(),
                 objects = ordered_json::array(), parameters = ordered_json::array();
    for (const scenarios::ActionForm& form : scenarios::action_forms())
        actions.push_back({{"verb", std::string(form.verb)},
                           {"usage", std::string(form.usage)},
                           {"help", std::string(form.help)},
                           {"keys", names_of(form.keys)}});
    for (const scenarios::ThingForm& form : scenarios::thing_forms())
        things.push_back({{"kind", std::string(form.kind)}, {"keys", names_of(form.keys)}});
    const auto add = [&](const auto& thing, const char* kind) {
        if (!thing.name.empty()) objects.push_back({{"name", thing.name}, {"kind", kind}});
    };
    for (const physics::Robot& robot : scenario.world.robots)
        add(robot, "robot");
    physics::for_each_thing(scenario.world, add);
    for (const physics::ParameterInfo& info : physics::parameter_table())
        if (physics::problem_of_tuning(info.name, info.defaults.front()).empty())
            parameters.push_back({{"name", info.name},
                                  {"unit", info.unit},
                                  {"range", {info.min, info.max}},
                                  {"fallback", info.defaults.front()}});
    return {{"actions", std::move(actions)},
            {"things", std::move(things)},
            {"objects", std::move(objects)},
            {"parameters", std::move(parameters)}};
}

}  // namespace puckloop::tools
