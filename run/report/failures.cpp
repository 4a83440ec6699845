#include "run/report/failures.h"

#include "base/json.h"
#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

namespace {

using nlohmann::json;

/// A wake-up and a configuration are the least that asks for an answer (docs/linux-programs.md).
constexpr std::uint64_t kLeastAsked = 5;

/// A fault on one of the node's lines: its silence was asked for.
bool has_fault(const RunSetup& setup, const std::string& node) {
    return std::any_of(setup.scenario.faults.begin(), setup.scenario.faults.end(), [&](const auto& fault) {
        if (fault.node == node) return true;
        return std::any_of(setup.links.begin(), setup.links.end(), [&](const cosim::LinkSpec& link) {
            return link.name == fault.link && (link.a.node == node || link.b.node == node);
        });
    });
}

/// The program's frames on its line came at a rate that the line's other end cannot read.
bool is_off_rate(const std::string& node, const cosim::Outcome& outcome) {
    return std::any_of(outcome.links.begin(), outcome.links.end(), [&](const auto& link) {
        return (link.a == node + ".uart" && link.from_a.uart_off_rate > 0) ||
               (link.b == node + ".uart" && link.from_b.uart_off_rate > 0);
    });
}

std::string silence_of(const std::string& node, const json& report, const cosim::Outcome& outcome) {
    const auto uart = report.find("uart");
    if (uart == report.end() || !report.contains("program")) return {};
    const auto sent = uart->value("sent", std::uint64_t{0});
    if (sent < kLeastAsked || uart->value("received", std::uint64_t{0}) > 0) return {};
    return silence_text(node, sent, outcome);
}

/// The board's own words, where it reports them.
std::string hang_of(const json& report) {
    const auto waiting = report.find("waiting");
    if (waiting == report.end() || !waiting->value("hung", false)) return {};
    if (const auto warnings = report.find("warnings"); warnings != report.end())
        for (const json& warning : *warnings)
            if (warning.is_string() && warning.get<std::string>().find(" in the loop ") != std::string::npos)
                return warning.get<std::string>();
    return fmt::format("hangs since {:.3f} s", waiting->value("since_s", 0.0));
}

}  // namespace

std::string silence_text(const std::string& node, std::uint64_t sent, const cosim::Outcome& outcome) {
    const std::string text = fmt::format("sent {} bytes and never received one: ", sent);
    if (is_off_rate(node, outcome))
        return text + "its port is not set to the rate of the line (cfsetspeed(), stty; the UART2 of a main "
                      "board has 115200 baud)";
    return text + fmt::format("was {} when the program began to speak ('start' in the scenario)?",
                              node == "coordinator.linux"
                                  ? "the radio module ready, its rate that of the port"
                                  : "the PIC ready");
}

std::vector<Failure> failures_of(const RunSetup& setup, const std::vector<std::string>& allowed,
                                 const cosim::Outcome& outcome) {
    std::vector<Failure> failures;
    const auto add = [&](const std::string& node, const char* kind, std::string text) {
        if (text.empty()) return;
        const bool may = std::find(allowed.begin(), allowed.end(), kind) != allowed.end();
        failures.push_back({node, kind, std::move(text), may});
    };
    for (const auto& node : outcome.nodes) {
        if (node.json.empty()) continue;
        const json report = json::parse(node.json);
        if (report.value("ended_badly", false))
            add(node.name, "program",
                fmt::format("{} {}", report.value("program", ""), report.value("end", "")));
        if (!has_fault(setup, node.name))
            add(node.name, "silent_line", silence_of(node.name, report, outcome));
        add(node.name, "hung", hang_of(report));
    }
    return failures;
}

void judge_failures(const std::vector<Failure>& failures, cosim::Outcome& outcome) {
    if (!outcome.success) return;
    for (const Failure& failure : failures) {
        if (failure.allowed) continue;
        outcome.success = false;
        outcome.node = failure.node;
        outcome.text = fmt::format("node {}: {}", failure.node, failure.text);
        return;
    }
}

}  // namespace puckloop::tools
