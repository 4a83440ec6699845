#include "cosim/faults/fault_json.h"

#include "base/error.h"
#include "base/json.h"
#include "base/plain_text.h"
#include "cosim/faults/node_fault.h"

#include <fmt/format.h>

namespace puckloop::cosim {

using nlohmann::ordered_json;

ordered_json fault_to_json(const FaultSpec& spec, std::uint64_t seed, std::size_t index) {
    ordered_json json{{"name", spec.name},
                      {"kind", spec.kind},
                      {"link", spec.link},
                      {"node", spec.node},
                      {"from", spec.from},
                      {"probability", spec.probability},
                      {"count", spec.count},
                      {"begin", spec.begin},
                      {"end", spec.end},
                      {"skip", spec.skip},
                      {"every", spec.every},
                      {"period", spec.period},
                      {"bytes", spec.bytes},
                      {"match", spec.match},
                      {"offset", spec.offset},
                      {"numbers", spec.parameters.numbers},
                      {"texts", spec.parameters.texts},
                      {"may_not_fire", spec.may_not_fire},
                      {"seed", seed},
                      {"index", index}};
    if (spec.position) json["position"] = *spec.position;
    if (spec.burst) json["burst"] = {spec.burst->p, spec.burst->r, spec.burst->bad, spec.burst->good};
    return json;
}

namespace {

NodeFault fault_from(const ordered_json& json) {
    NodeFault fault;
    FaultSpec& spec = fault.spec;
    json.at("name").get_to(spec.name);
    json.at("kind").get_to(spec.kind);
    json.at("link").get_to(spec.link);
    json.at("node").get_to(spec.node);
    json.at("from").get_to(spec.from);
    json.at("probability").get_to(spec.probability);
    json.at("count").get_to(spec.count);
    json.at("begin").get_to(spec.begin);
    json.at("end").get_to(spec.end);
    json.at("skip").get_to(spec.skip);
    json.at("every").get_to(spec.every);
    json.at("period").get_to(spec.period);
    json.at("bytes").get_to(spec.bytes);
    json.at("match").get_to(spec.match);
    json.at("offset").get_to(spec.offset);
    for (const auto& [key, value] : json.at("numbers").items())
        spec.set(key, value.get<double>());
    for (const auto& [key, value] : json.at("texts").items())
        spec.set(key, value.get<std::string>());
    json.at("may_not_fire").get_to(spec.may_not_fire);
    if (json.contains("position")) spec.position = json["position"].get<std::uint32_t>();
    if (json.contains("burst")) {
        const auto& burst = json["burst"];
        spec.burst = Burst{burst.at(0), burst.at(1), burst.at(2), burst.at(3)};
    }
    json.at("seed").get_to(fault.seed);
    json.at("index").get_to(fault.index);
    return fault;
}

CarriedFault carried(const NodeFault& fault) {
    return {fault.spec, Trigger(fault.spec, fault_stream(fault.spec, fault.seed, fault.index))};
}

}  // namespace

JsonValue to_value(const NodeFault& fault) {
    return parse_json(fault_to_json(fault.spec, fault.seed, fault.index).dump());
}

std::vector<NodeFault> node_faults(const JsonValue& list) {
    std::vector<NodeFault> faults;
    if (list.is_null()) return faults;
    try {
        for (const ordered_json& json : ordered_json::parse(dump(list)))
            faults.push_back(fault_from(json));
    } catch (const nlohmann::json::exception& error) {
        throw InputError("", "faults", reason_of(error));
    }
    return faults;
}

std::vector<CarriedFault> carried(const std::vector<NodeFault>& faults) {
    std::vector<CarriedFault> list;
    for (const NodeFault& fault : faults)
        list.push_back(carried(fault));
    return list;
}

std::vector<CarriedFault> faults_from_json(const ordered_json& list) {
    std::vector<CarriedFault> faults;
    if (list.is_null()) return faults;
    try {
        for (const ordered_json& json : list)
            faults.push_back(carried(fault_from(json)));
    } catch (const nlohmann::json::exception& error) {
        throw InputError("", "faults", reason_of(error));
    }
    return faults;
}

ordered_json fault_results(const std::vector<CarriedFault>& faults, Time end) {
    ordered_json list = ordered_json::array();
    for (const CarriedFault& fault : faults) {
        ordered_json firings = ordered_json::array();
        for (const Firing& firing : fault.evidence.firings(end))
            firings.push_back({firing.time, firing.index, firing.what});
        list.push_back(
            {{"name", fault.spec.name}, {"fired", fault.evidence.fired(end)}, {"firings", firings}});
        if (const auto last = fault.evidence.last(end)) list.back()["last"] = *last;
    }
    return list;
}

void add_fault_result(FaultReport& report, const ordered_json& result) {
    std::vector<Firing> firings;
    for (const ordered_json& one : result.at("firings"))
        firings.push_back(
            {one.at(0).get<Time>(), one.at(1).get<std::uint64_t>(), {}, one.at(2).get<std::string>()});
    std::optional<Time> last;
    if (result.contains("last")) last = result["last"].get<Time>();
    report.add(result.at("fired").get<std::uint64_t>(), last, std::move(firings));
}

}  // namespace puckloop::cosim
