#include "run/driven/possible_faults.h"

#include "cosim/faults/kinds/kind_table.h"
#include "scenarios/reader/faults/fault_places.h"

#include <nlohmann/json.hpp>

#include <array>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

constexpr std::array kPlaces{"uart", "radio", "i2c",  "infrared", "pic", "rab",
                             "tam",  "linux", "xbee", "ircom",    "can"};
constexpr std::array kUnits{"time",      "ratio",   "number", "integer", "voltage",
                            "frequency", "degrees", "flag",   "byte",    "text"};
constexpr std::array kStyles{"each", "hold", "times"};

ordered_json json_of(const cosim::ParameterInfo& parameter) {
    ordered_json json{{"key", parameter.key},
                      {"unit", kUnits.at(static_cast<std::size_t>(parameter.unit))},
                      {"required", parameter.required}};
    if (parameter.high > parameter.low) json["range"] = {parameter.low, parameter.high};
    if (parameter.fallback) json["fallback"] = *parameter.fallback;
    if (!parameter.choices.empty()) json["choices"] = parameter.choices;
    return json;
}

}  // namespace

ordered_json possible_faults(const scenarios::Scenario& scenario) {
    ordered_json kinds = ordered_json::array(), places = ordered_json::array();
    for (const cosim::KindInfo& kind : cosim::all_kinds()) {
        ordered_json parameters = ordered_json::array();
        for (const cosim::ParameterInfo& parameter : kind.parameters)
            parameters.push_back(json_of(parameter));
        kinds.push_back({{"name", kind.name},
                         {"on", kPlaces.at(static_cast<std::size_t>(kind.place))},
                         {"style", kStyles.at(static_cast<std::size_t>(kind.style))},
                         {"parameters", std::move(parameters)}});
    }
    for (const scenarios::FaultPlace& place : scenarios::fault_places(scenario))
        places.push_back({{"name", place.name},
                          {"on", kPlaces.at(static_cast<std::size_t>(place.kind))},
                          {"key", place.is_node ? "node" : "link"},
                          {"ends", place.ends}});
    return {{"kinds", std::move(kinds)}, {"places", std::move(places)}};
}

}  // namespace puckloop::tools
