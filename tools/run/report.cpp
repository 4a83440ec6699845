#include "tools/run/report.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <fstream>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;

std::string_view reason_name(cosim::EndReason reason) {
    switch (reason) {
    case cosim::EndReason::Duration:
        return "duration";
    case cosim::EndReason::NodeStopped:
        return "node stopped";
    case cosim::EndReason::Interrupted:
        return "interrupted";
    case cosim::EndReason::Failed:
        return "failed";
    }
    return "";
}

ordered_json node_json(const cosim::Outcome::NodeReport& node) {
    if (node.json.empty()) return {{"lost", true}};
    return ordered_json::parse(node.json);
}

double real_time_factor(const cosim::Outcome& outcome) {
    return outcome.wall_s > 0 ? cosim::to_seconds(outcome.simulated) / outcome.wall_s : 0.0;
}

/// Registers that firmware touched and no model stands behind, gathered from every node.
ordered_json unmodelled_of(const ordered_json& nodes) {
    ordered_json all = ordered_json::array();
    for (const auto& [name, node] : nodes.items()) {
        if (!node.contains("unmodelled")) continue;
        for (ordered_json touch : node["unmodelled"]) {
            touch["node"] = name;
            all.push_back(touch);
        }
    }
    return all;
}

}  // namespace

void write_report(const RunSetup& setup, const cosim::Outcome& outcome) {
    ordered_json nodes = ordered_json::object();
    ordered_json warnings = outcome.warnings;
    for (const auto& node : outcome.nodes) {
        nodes[node.name] = node_json(node);
        if (nodes[node.name].contains("warnings"))
            for (const auto& warning : nodes[node.name]["warnings"])
                warnings.push_back(fmt::format(
                    "{}: {}", node.name, warning.is_string() ? warning.get<std::string>() : warning.dump()));
    }
    ordered_json links = ordered_json::object();
    for (const auto& link : outcome.links)
        links[link.name] = {{"a", link.a},
                            {"b", link.b},
                            {"from_a", ordered_json::parse(to_json(link.from_a))},
                            {"from_b", ordered_json::parse(to_json(link.from_b))}};
    ordered_json faults = ordered_json::array();
    for (const auto& fault : outcome.faults)
        faults.push_back({{"fault", fault.text}, {"fired", fault.fired}});
    const ordered_json report{{"scenario", setup.scenario.file.string()},
                              {"seed", setup.scenario.seed},
                              {"success", outcome.success},
                              {"ended_by", reason_name(outcome.reason)},
                              {"ended_why", outcome.text},
                              {"simulated_s", cosim::to_seconds(outcome.simulated)},
                              {"wall_s", outcome.wall_s},
                              {"real_time_factor", real_time_factor(outcome)},
                              {"trace_sha256", outcome.trace_sha256},
                              {"grants", outcome.grants},
                              {"nodes", nodes},
                              {"links", links},
                              {"faults", faults},
                              {"warnings", warnings},
                              {"unmodelled_registers", unmodelled_of(nodes)}};
    const auto path = setup.out / "report.json";
    std::ofstream file(path);
    file << report.dump(2) << '\n';
    file.flush();
    if (!file) throw RunError(fmt::format("{}: cannot be written", path.string()));
}

std::string summary(const RunSetup& setup, const cosim::Outcome& outcome) {
    std::string text =
        fmt::format("{:.3f} s simulated in {:.1f} s ({:.1f}x real time)",
                    cosim::to_seconds(outcome.simulated), outcome.wall_s, real_time_factor(outcome));
    if (!outcome.text.empty()) text += fmt::format("\nended: {}", outcome.text);
    for (const std::string& warning : outcome.warnings)
        text += fmt::format("\nwarning: {}", warning);
    text += fmt::format("\ntrace {}\nresults in {}", outcome.trace_sha256, setup.out.string());
    return text;
}

}  // namespace puckloop::tools
