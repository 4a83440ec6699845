#include "run/driven/possible_faults.h"

#include "base/json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "scenarios/reader/faults/fault_places.h"

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

// Switches, so that a kind that is added is missed by the compiler.
const char* name_of(cosim::PlaceKind place) {
    using cosim::PlaceKind;
    switch (place) {
    case PlaceKind::Uart:
        return "uart";
    case PlaceKind::Radio:
        return "radio";
    case PlaceKind::I2c:
        return "i2c";
    case PlaceKind::InfraRed:
        return "infrared";
    case PlaceKind::Pic:
        return "pic";
    case PlaceKind::Rab:
        return "rab";
    case PlaceKind::Tam:
        return "tam";
    case PlaceKind::Linux:
        return "linux";
    case PlaceKind::Xbee:
        return "xbee";
    case PlaceKind::Ircom:
        return "ircom";
    case PlaceKind::Can:
        return "can";
    case PlaceKind::Network:
        return "network";
    }
    return "";
}

const char* name_of(cosim::Unit unit) {
    using cosim::Unit;
    switch (unit) {
    case Unit::Time:
        return "time";
    case Unit::Ratio:
        return "ratio";
    case Unit::Number:
        return "number";
    case Unit::Integer:
        return "integer";
    case Unit::Voltage:
        return "voltage";
    case Unit::Frequency:
        return "frequency";
    case Unit::Degrees:
        return "degrees";
    case Unit::Flag:
        return "flag";
    case Unit::Byte:
        return "byte";
    case Unit::Text:
        return "text";
    }
    return "";
}

const char* name_of(cosim::Style style) {
    using cosim::Style;
    switch (style) {
    case Style::Each:
        return "each";
    case Style::Hold:
        return "hold";
    case Style::Times:
        return "times";
    }
    return "";
}

ordered_json json_of(const cosim::ParameterInfo& parameter) {
    ordered_json json{
        {"key", parameter.key}, {"unit", name_of(parameter.unit)}, {"required", parameter.required}};
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
                         {"on", name_of(kind.place)},
                         {"style", name_of(kind.style)},
                         {"parameters", std::move(parameters)}});
    }
    for (const scenarios::FaultPlace& place : scenarios::fault_places(scenario))
        places.push_back({{"name", place.name},
                          {"on", name_of(place.kind)},
                          {"key", place.is_node ? "node" : "link"},
                          {"ends", place.ends}});
    return {{"kinds", std::move(kinds)}, {"places", std::move(places)}};
}

}  // namespace puckloop::tools
