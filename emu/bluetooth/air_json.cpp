// The node from JSON, and its report.

#include "base/error.h"
#include "emu/bluetooth/air_node.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>

namespace puckloop::bluetooth {

using nlohmann::json;

namespace {

json to_json(const Module& module) {
    const ModuleCounts& counts = module.counts();
    return {{"address", protocols::lmx_address_text(module.settings().address)},
            {"name", module.settings().name},
            {"bytes_in", counts.bytes_in},
            {"bytes_out", module.serial().sent()},
            {"while_down", counts.while_down},
            {"framing_errors", counts.framing_errors},
            {"between_packets", counts.between_packets},
            {"bad_packets", counts.bad_packets},
            {"requests", counts.requests},
            {"errors", counts.errors},
            {"not_modelled", counts.not_modelled},
            {"transparent_in", counts.transparent_in},
            {"transparent_out", counts.transparent_out},
            {"resets", counts.resets}};
}

cosim::Time time_of(const json& from, const char* key, cosim::Time fallback) {
    return cosim::from_seconds(from.value(key, cosim::to_seconds(fallback)));
}

Spread spread_of(const json& from, const char* key, const Spread& fallback) {
    if (!from.contains(key)) return fallback;
    return {from[key].at(0).get<double>(), from[key].at(1).get<double>()};
}

RobotModule module_from(const json& from) {
    RobotModule robot;
    ModuleOptions& module = robot.module;
    module.name = from.at("name");
    module.boot = time_of(from, "boot_s", module.boot);
    module.processing = time_of(from, "processing_s", module.processing);
    Settings& settings = module.settings;
    settings.name = from.value("friendly_name", settings.name);
    settings.pin = from.value("pin", settings.pin);
    settings.automatic = from.value("automatic", settings.automatic);
    if (from.contains("address"))
        settings.address = parse_address(module.name, from["address"].get<std::string>());
    robot.pose = from.value("pose", robot.pose);
    return robot;
}

ComputerOptions computer_from(const json& from) {
    ComputerOptions computer;
    computer.name = from.at("name");
    computer.address = parse_address(computer.name, from.at("address").get<std::string>());
    computer.robot = parse_address(computer.name, from.at("robot").get<std::string>());
    computer.pin = from.value("pin", computer.pin);
    computer.connect = time_of(from, "connect_s", computer.connect);
    return computer;
}

}  // namespace

Address parse_address(std::string_view place, std::string_view text) {
    Address address{};
    const auto refuse = [&] {
        throw InputError("", place, fmt::format("'{}' is no Bluetooth address", text),
                         "six octets: \"08:00:17:2C:00:01\"");
    };
    constexpr std::size_t kText = 17;
    if (text.size() != kText) refuse();
    for (std::size_t i = 0; i < address.size(); ++i) {
        const char* first = text.data() + 3 * i;
        unsigned octet = 0;
        const auto [end, error] = std::from_chars(first, first + 2, octet, 16);
        if (error != std::errc() || end != first + 2 || (i > 0 && first[-1] != ':')) refuse();
        address[address.size() - 1 - i] = static_cast<std::uint8_t>(octet);
    }
    return address;
}

std::string AirNode::finish() {
    json modules = json::object();
    std::vector<std::string> warnings;
    for (const auto& module : modules_) {
        modules[std::string(module->name())] = to_json(*module);
        for (const auto& [request, times] : module->counts().not_modelled)
            warnings.push_back(
                fmt::format("{}: the Bluetooth module does not model {}", module->name(), request));
    }
    const NetworkCounts& counts = network_.counts();
    if (log_ != nullptr) std::fflush(log_);
    return json{{"inquiries", counts.inquiries},
                {"found", counts.found},
                {"not_found_in_time", counts.missed},
                {"names", counts.names},
                {"names_missing", counts.names_missing},
                {"attempts", counts.attempts},
                {"links", counts.links},
                {"nobody", counts.not_found},
                {"refused", counts.refused},
                {"lost", counts.lost},
                {"bytes", counts.bytes},
                {"bytes_lost", counts.bytes_lost},
                {"modules", std::move(modules)},
                {"warnings", warnings}}
        .dump();
}

std::unique_ptr<cosim::Node> make_air_node(std::string_view text) {
    AirSpec spec;
    try {
        const auto from = json::parse(text);
        spec.name = from.value("name", spec.name);
        spec.seed = from.value("seed", spec.seed);
        spec.range = from.value("range_m", spec.range);
        spec.csv = from.value("csv", spec.csv);
        spec.times.discovery = from.value("discovery_s", spec.times.discovery);
        spec.times.name = spread_of(from, "name_s", spec.times.name);
        spec.times.link = spread_of(from, "link_s", spec.times.link);
        spec.times.release = spread_of(from, "release_s", spec.times.release);
        for (const auto& module : from.at("modules"))
            spec.modules.push_back(module_from(module));
        if (from.contains("computers"))
            for (const auto& computer : from["computers"])
                spec.computers.push_back(computer_from(computer));
    } catch (const json::exception& error) {
        throw InputError("", "Bluetooth description", error.what());
    }
    return std::make_unique<AirNode>(spec);
}

}  // namespace puckloop::bluetooth
