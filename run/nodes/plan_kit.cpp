#include "run/nodes/plan_kit.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::tools {

std::vector<std::string> names_of(std::span<const cosim::SignalInfo> signals) {
    std::vector<std::string> names;
    for (const cosim::SignalInfo& signal : signals)
        names.push_back(signal.name);
    return names;
}

std::map<std::string, std::uint16_t> ids_of(std::span<const cosim::SignalInfo> signals) {
    std::map<std::string, std::uint16_t> ids;
    for (std::size_t i = 0; i < signals.size(); ++i)
        ids[signals[i].name] = static_cast<std::uint16_t>(i);
    return ids;
}

std::string log_of(const RunSetup& setup, const std::string& node) {
    return (setup.out / (node + ".log")).string();
}

void add_free(RunSetup& setup, const std::string& name, NodeKind spec) {
    setup.nodes.push_back({name, {std::move(spec)}});
    setup.nodes.back().any_thread = true;
}

void add_outside(RunSetup& setup, const std::string& name, const std::string& end, double baud,
                 const cosim::PortRef& board, double nominal_baud, const RunRequest& request) {
    const std::filesystem::path folder = std::filesystem::absolute(setup.scenario.file).parent_path();
    const exec::UartSpec parsed = parse_outside(name, end, folder.string());
    if (parsed.kind != exec::UartSpec::Kind::Script && !request.realtime && !request.paced)
        throw InputError(setup.scenario.file.string(), name, fmt::format("'{}' has a clock of its own", end),
                         "--realtime or --paced, or script:FILE");
    OutsideSpec spec{
        .name = name, .end = parsed, .baud = baud, .record = (setup.out / (name + ".received")).string()};
    setup.nodes.push_back({name, {std::move(spec)}});
    setup.nodes.back().outside = parsed.kind != exec::UartSpec::Kind::Script;
    setup.links.push_back({name, {name, "uart"}, board, nominal_baud});
}

}  // namespace puckloop::tools
