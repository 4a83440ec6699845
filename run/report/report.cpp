#include "run/report/report.h"
#include "run/report/failures.h"

#include "base/error.h"
#include "base/json.h"
#include "run/plan/state_plan.h"
#include "run/plan/stats_plan.h"
#include "run/report/alike_warnings.h"
#include "run/report/fault_results.h"
#include "run/report/mission_score.h"
#include "run/report/supply_resets.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace puckloop::tools {

namespace {

/// In s: after it programs get their end signals.
double end_of(const scenarios::Scenario& scenario) {
    return scenario.duration.value_or(std::numeric_limits<double>::infinity());
}

using nlohmann::ordered_json;

constexpr std::size_t kShown = 10;  ///< warnings on the terminal

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
    case cosim::EndReason::Reverted:
        break;  // and begun again: nobody reports it
    }
    return "";
}

ordered_json node_json(const cosim::Outcome::NodeReport& node) {
    if (node.json.empty()) return {{"lost", true}};
    return ordered_json::parse(node.json);
}

ordered_json seconds_or_null(const std::optional<cosim::Time>& time) {
    return time ? ordered_json(cosim::to_seconds(*time)) : ordered_json(nullptr);
}

double real_time_factor(const RunSetup& setup, const cosim::Outcome& outcome) {
    const cosim::Time span = outcome.simulated - std::min(setup.from_time, outcome.simulated);
    return outcome.wall_s > 0 ? cosim::to_seconds(span) / outcome.wall_s : 0.0;
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

ordered_json failures_json(const std::vector<Failure>& failures) {
    ordered_json list = ordered_json::array();
    for (const Failure& failure : failures)
        list.push_back({{"node", failure.node},
                        {"kind", failure.kind},
                        {"text", failure.text},
                        {"allowed", failure.allowed}});
    return list;
}

ordered_json expectations_json(const std::vector<ExpectationResult>& expectations) {
    ordered_json list = ordered_json::array();
    for (const ExpectationResult& one : expectations)
        list.push_back({{"name", one.name},
                        {"met", one.met},
                        {"why", one.why},
                        {"at_s", one.at ? ordered_json(*one.at) : ordered_json(nullptr)}});
    return list;
}

/// What happened to the world.
ordered_json events_of(const ordered_json& nodes) {
    const auto world = nodes.find("world");
    return world == nodes.end() ? ordered_json::array() : world->value("events", ordered_json::array());
}

/// What a Linux program's counters say that its user should hear.
void add_linux_warnings(const std::string& name, const ordered_json& node, const cosim::Outcome& outcome,
                        std::vector<std::string>& warnings) {
    if (!node.contains("program")) return;
    const auto count = [&](const char* port, const char* what) -> std::uint64_t {
        const auto found = node.find(port);
        return found == node.end() ? 0 : found->value(what, std::uint64_t{0});
    };
    if (count("uart", "sent") > 0 && count("uart", "received") == 0)
        warnings.push_back(name + ": " + silence_text(name, count("uart", "sent"), outcome));
    if (const auto failed = count("i2c", "failed"); failed > 0)
        warnings.push_back(fmt::format("{}: {} of {} I2C transfers failed (the bus's log has the addresses)",
                                       name, failed, count("i2c", "transfers")));
}

}  // namespace

std::vector<std::string> warnings_of(const RunSetup& setup, const cosim::Outcome& outcome) {
    std::vector<std::string> warnings = setup.warnings;
    warnings.insert(warnings.end(), outcome.warnings.begin(), outcome.warnings.end());
    for (const auto& node : outcome.nodes) {
        const ordered_json json = node_json(node);
        add_linux_warnings(node.name, json, outcome, warnings);
        if (!json.contains("warnings")) continue;
        for (const auto& warning : json["warnings"])
            warnings.push_back(fmt::format(
                "{}: {}", node.name, warning.is_string() ? warning.get<std::string>() : warning.dump()));
    }
    return warnings;
}

/// What the run scored: by its table, or as its program counted. Null where neither is.
ordered_json mission_of(const RunSetup& setup, const cosim::Outcome& outcome) {
    if (setup.scenario.mission)
        return mission_score(*setup.scenario.mission, setup.out / "trajectory.csv", end_of(setup.scenario));
    for (const auto& node : outcome.nodes)
        if (const ordered_json json = node_json(node); node.name == "world" && json.contains("mission"))
            return json.at("mission");
    return nullptr;
}

void judge(cosim::Outcome& outcome) {
    if (!outcome.success) return;
    for (const auto& node : outcome.nodes) {
        const ordered_json json = node_json(node);
        if (!json.contains("mission") || !json["mission"].contains("why")) continue;
        outcome.success = false;
        outcome.node = node.name;
        outcome.text = json["mission"]["why"].get<std::string>();
        return;
    }
    if (outcome.reason != cosim::EndReason::Duration) return;
    for (const auto& node : outcome.nodes) {
        const ordered_json json = node_json(node);
        if (!json.value("never_opened_a_device", false)) continue;
        outcome.success = false;
        outcome.node = node.name;
        outcome.text =
            fmt::format("node {}: {} never opened its serial port or I2C bus in {:.3f} s", node.name,
                        json.value("program", ""), cosim::to_seconds(outcome.simulated));
        return;
    }
}

void judge_strictly(const RunSetup& setup, cosim::Outcome& outcome) {
    if (!outcome.success) return;
    const std::vector<std::string> warnings = warnings_of(setup, outcome);
    if (warnings.empty()) return;
    outcome.success = false;
    outcome.text = "with --strict a warning is a failure: " + warnings.front();
}

void write_report(const RunSetup& setup, const cosim::Outcome& outcome, const std::vector<UsedFile>& files,
                  const std::vector<Failure>& failures, const std::vector<ExpectationResult>& expectations,
                  ReservedFile& file) {
    ordered_json nodes = ordered_json::object();
    for (const auto& node : outcome.nodes)
        nodes[node.name] = node_json(node);
    ordered_json links = ordered_json::object();
    for (const auto& link : outcome.links)
        links[link.name] = {{"a", link.a},
                            {"b", link.b},
                            {"from_a", ordered_json::parse(to_json(link.from_a))},
                            {"from_b", ordered_json::parse(to_json(link.from_b))}};
    ordered_json report{{"format", kReportFormat},
                        {"puckloop", version_json()},
                        {"command_line", command_line_json()},
                        {"scenario", setup.scenario.file.string()},
                        {"scenario_sha256", setup.scenario_sha256},
                        {"files", files_json(files)},
                        {"seed", setup.scenario.seed},
                        {"success", outcome.success},
                        {"ended_by", reason_name(outcome.reason)},
                        {"ended_why", outcome.text},
                        {"failures", failures_json(failures)},
                        {"programs_asked_to_end_s", seconds_or_null(outcome.wind_up)},
                        {"simulated_s", cosim::to_seconds(outcome.simulated)},
                        {"wall_s", outcome.wall_s},
                        {"real_time_factor", real_time_factor(setup, outcome)},
                        {"trace_sha256", outcome.trace_sha256},
                        {"grants", outcome.grants},
                        {"nodes", nodes},
                        {"links", links},
                        {"faults", faults_json(outcome)},
                        {"events", events_of(nodes)},
                        {"warnings", warnings_of(setup, outcome)},
                        {"unmodelled_registers", unmodelled_of(nodes)}};
    if (ordered_json mission = mission_of(setup, outcome); !mission.is_null())
        report["mission"] = std::move(mission);
    if (!expectations.empty()) report["expectations"] = expectations_json(expectations);
    if (!setup.scenario.not_taken.empty()) report["not_taken_over"] = setup.scenario.not_taken;
    if (!setup.from.empty())
        report["from"] = {{"file", setup.from.string()},
                          {"at_s", cosim::to_seconds(setup.from_time)},
                          {"restored_s", outcome.restored_s}};
    for (const exec::RelayedPort& port : setup.joined)
        report["joined_ports"].push_back(port.port);
    if (!setup.cache_unused.empty()) report["cache_unused"] = setup.cache_unused;
    file.write(report.dump(2) + "\n");
}

std::string summary(const RunSetup& setup, const cosim::Outcome& outcome) {
    std::string text =
        fmt::format("{:.3f} s simulated in {:.1f} s ({:.1f}x real time)",
                    cosim::to_seconds(outcome.simulated), outcome.wall_s, real_time_factor(setup, outcome));
    if (outcome.success && !outcome.text.empty()) text += fmt::format("\nended: {}", outcome.text);
    text += states_summary(setup, outcome) + stats_summary(outcome) + faults_summary(outcome) +
            supply_resets_summary(outcome);
    if (const ordered_json mission = mission_of(setup, outcome); !mission.is_null())
        text += "\n" + mission_summary(mission);
    const std::vector<std::string> warnings = alike_as_one(warnings_of(setup, outcome));
    for (std::size_t i = 0; i < warnings.size() && i < kShown; ++i)
        text += fmt::format("\nwarning: {}", warnings[i]);
    if (warnings.size() > kShown)
        text += fmt::format("\nwarning: and {} more in report.json", warnings.size() - kShown);
    text += fmt::format("\ntrace {}\nresults in {}", outcome.trace_sha256, setup.out.string());
    return text;
}

}  // namespace puckloop::tools
