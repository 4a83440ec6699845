#include "run/plan/stats_plan.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

using nlohmann::json;

void check(const RunRequest& request) {
    const auto refuse = [](const char* what) {
        throw InputError("", "--stats", what, "a run that begins at power-up, without a debugger");
    };
    if (!request.gdb.empty()) refuse("a debugger and --stats do not go together");
    if (request.snapshot) refuse("a run from a snapshot lacks what was written before it");
    if (!request.from_state.empty()) refuse("boards from a saved state lack what was written before it");
    if (!request.save_state.empty()) refuse("--save-state and --stats do not go together");
}

/// "0x0904 main+0x4 (main.c:12)"
std::string place_of(const json& entry) {
    std::string text = entry.at("pc");
    if (const std::string place = entry.at("place"); !place.empty()) text += " " + place;
    if (const std::string line = entry.at("line"); !line.empty()) text += " (" + line + ")";
    return text;
}

std::string stack_text(const json& stats) {
    if (!stats.contains("stack")) return "no call was made";
    const json& stack = stats["stack"];
    std::string text = fmt::format("stack {} bytes at most", stack.at("bytes").get<std::uint64_t>());
    if (stack.contains("left")) text += fmt::format(", {} left", stack["left"].get<std::uint64_t>());
    return text + ", at " + place_of(stack);
}

std::string reads_text(const json& stats) {
    const auto times = stats.at("unwritten_reads").get<std::uint64_t>();
    if (times == 0) return "no byte of RAM was read before it was written";
    const json& first = stats.at("unwritten").at(0);
    const std::string name = first.at("variable");
    return fmt::format("{} of bytes of RAM that nothing had written, first 0x{:04x}{} at {}",
                       times == 1 ? "1 read" : fmt::format("{} reads", times),
                       first.at("address").get<std::uint32_t>(),
                       name.empty() ? "" : fmt::format(" ({})", name), place_of(first));
}

}  // namespace

void plan_stats(RunSetup& setup, const RunRequest& request) {
    if (request.stats.empty()) return;
    check(request);
    for (const std::string& wanted : request.stats) {
        std::string known;
        bool found = false;
        for (PlannedNode& node : setup.nodes) {
            if (!has_board(node.what)) continue;
            known += node.name + ", ";
            if (wanted != node.name && wanted != kind_name(node.what) && wanted != "all") continue;
            found = true;
            node.what.care.stats = true;
            node.what.care.from_state.reset();  // of the boot cache
            node.what.care.save_state.reset();
        }
        if (!found)
            throw InputError("", "--stats", fmt::format("'{}' names no board of the scenario", wanted),
                             "one of " + known + "or pic, rab, tam or all");
    }
}

std::string stats_summary(const cosim::Outcome& outcome) {
    std::string text;
    for (const auto& node : outcome.nodes) {
        if (node.json.find("\"stats\"") == std::string::npos) continue;  // nothing to parse
        const json report = json::parse(node.json);
        const auto stats = report.find("stats");
        if (stats == report.end()) continue;
        text += fmt::format("\n{}: {}\n{}: {}", node.name, stack_text(*stats), node.name, reads_text(*stats));
    }
    return text;
}

}  // namespace puckloop::tools
