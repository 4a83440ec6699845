#include "run/report/fault_results.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "base/json.h"
#include "cosim/faults/fault_json.h"
#include "cosim/faults/kinds/kind_facts.h"
#include "cosim/trace/trace_row.h"
#include "run/plan/node_faults.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

namespace puckloop::tools {

using nlohmann::ordered_json;

namespace {

constexpr std::size_t kFiringsInReport = 10;
constexpr std::size_t kFaultsInSummary = 5;

/// What can be said of a fault that never fired from its own words; may be empty.
std::string why_it_did_not(const RunSetup& setup, const cosim::FaultReport& report, cosim::Time end) {
    const auto& faults = setup.scenario.faults;
    const auto fault = std::find_if(faults.begin(), faults.end(),
                                    [&](const cosim::FaultSpec& one) { return one.name == report.name; });
    if (fault == faults.end()) return "";
    if (fault->begin >= end)
        return fmt::format("; its window begins at {:.3f} s and the run ended at {:.3f} s",
                           cosim::to_seconds(fault->begin), cosim::to_seconds(end));
    const std::string_view why = cosim::why_silent(*fault);
    return why.empty() ? "" : fmt::format("; {}", why);
}

/// A node's report, null if it could not give one.
ordered_json report_of_node(const cosim::Outcome::NodeReport& node) {
    return node.json.empty() ? ordered_json() : ordered_json::parse(node.json, nullptr, false);
}

bool has_evidence(const RunSetup& setup, const std::string& node, const std::string& name) {
    const auto& faults = setup.scenario.faults;
    return std::none_of(faults.begin(), faults.end(), [&](const cosim::FaultSpec& fault) {
        return fault.name == name && shared_with(setup, fault) == node;
    });
}

ordered_json to_json(const cosim::Firing& firing) {
    ordered_json json{{"time_ps", firing.time}, {"index", firing.index}};
    if (!firing.from.empty()) json["from"] = firing.from;
    json["what"] = firing.what;
    return json;
}

}  // namespace

void take_fault_results(const RunSetup& setup, cosim::Outcome& outcome) {
    for (const auto& node : outcome.nodes) {
        const ordered_json report = report_of_node(node);
        if (!report.is_object() || !report.contains("faults")) continue;
        for (const ordered_json& result : report["faults"])
            for (cosim::FaultReport& fault : outcome.faults)
                if (fault.name == result.value("name", "") && has_evidence(setup, node.name, fault.name))
                    cosim::add_fault_result(fault, result);
    }
    if (!outcome.success) return;
    std::size_t others = 0;
    for (const cosim::FaultReport& fault : outcome.faults) {
        if (!fault.failed_to_fire()) continue;
        if (!std::exchange(outcome.success, false)) {
            ++others;
            continue;
        }
        outcome.text = fmt::format("fault {} never fired: {}{}", fault.name, fault.text,
                                   why_it_did_not(setup, fault, outcome.simulated));
    }
    if (outcome.success) return;
    if (others > 0) outcome.text += fmt::format("; nor did {} more", others);
    outcome.text += " (may_not_fire = true allows that)";
}

std::string faults_summary(const cosim::Outcome& outcome) {
    std::string text;
    std::size_t shown = 0, fired = 0;
    for (const cosim::FaultReport& fault : outcome.faults) {
        if (fault.fired == 0) continue;
        if (++fired > kFaultsInSummary) continue;
        ++shown;
        text += fmt::format("\nfault {}: fired {}", fault.name,
                            fault.fired == 1 ? std::string("once") : fmt::format("{} times", fault.fired));
        if (!fault.firings.empty())
            text += fmt::format(", first at {:.6f} s ({})", cosim::to_seconds(fault.firings[0].time),
                                fault.firings[0].what);
    }
    if (fired > shown) text += fmt::format("\nand {} more faults fired: faults.csv", fired - shown);
    return text;
}

ordered_json faults_json(const cosim::Outcome& outcome) {
    ordered_json faults = ordered_json::array();
    for (const cosim::FaultReport& fault : outcome.faults) {
        ordered_json firings = ordered_json::array();
        for (std::size_t i = 0; i < std::min(fault.firings.size(), kFiringsInReport); ++i)
            firings.push_back(to_json(fault.firings[i]));
        faults.push_back(
            {{"name", fault.name},
             {"fault", fault.text},
             {"kind", fault.kind},
             {"place", fault.place},
             {"may_not_fire", fault.may_not_fire},
             {"fired", fault.fired},
             {"first_ps", fault.firings.empty() ? ordered_json() : ordered_json(fault.firings[0].time)},
             {"last_ps", fault.last ? ordered_json(*fault.last) : ordered_json()},
             {"first_s", fault.firings.empty() ? ordered_json()
                                               : ordered_json(cosim::to_seconds(fault.firings[0].time))},
             {"firings", firings}});
    }
    return faults;
}

void write_faults_csv(const cosim::Outcome& outcome, const std::filesystem::path& file) {
    make_new_file(file);
    std::ofstream out(file);
    out << "fault,kind,place,firing,time_s,from,index,what\n";
    for (const cosim::FaultReport& fault : outcome.faults)
        for (std::size_t i = 0; i < fault.firings.size(); ++i) {
            const cosim::Firing& one = fault.firings[i];
            out << fmt::format("{},{},{},{},{},{},{},{}\n", fault.name, fault.kind, fault.place, i,
                               cosim::format_seconds(one.time), one.from, one.index, one.what);
        }
    out.close();
    if (!out) throw RunError(fmt::format("{} cannot be written", file.string()));
}

}  // namespace puckloop::tools
