#include "run/report/supply_resets.h"

#include "base/json.h"
#include "base/text/times_text.h"

#include <fmt/format.h>

#include <map>
#include <vector>

namespace puckloop::tools {

namespace {

using nlohmann::json;

constexpr std::size_t kShownResets = 10;  ///< lines on the terminal

/// Causes in a node's `resets`, as dsPICs and AVRs give them.
const std::map<std::string, std::string> kCauses{{"BOR", "brown-out (BOR)"},
                                                 {"POR", "power-on (POR)"},
                                                 {"brown-out", "brown-out (BORF)"},
                                                 {"power-on", "power-on (PORF)"}};

std::string place_of_reset(const json& reset) {
    std::string text = reset.at("pc").get<std::string>();
    if (reset.contains("symbol")) text += " in " + reset["symbol"].get<std::string>();
    return text;
}

/// One line per cause. The first reset of all is the power-up.
void add_lines(const std::string& board, const json& resets, std::vector<std::string>& lines) {
    std::map<std::string, std::vector<const json*>> by_cause;
    for (std::size_t i = 1; i < resets.size(); ++i)
        if (const auto cause = kCauses.find(resets[i].at("cause")); cause != kCauses.end())
            by_cause[cause->second].push_back(&resets[i]);
    for (const auto& [cause, list] : by_cause)
        lines.push_back(fmt::format("reset: {}, {} {}, first at pc {} ({:.6f} s)", board, cause,
                                    times_text(list.size()), place_of_reset(*list.front()),
                                    list.front()->at("time_s").get<double>()));
}

}  // namespace

std::string supply_resets_summary(const cosim::Outcome& outcome) {
    std::vector<std::string> lines;
    for (const auto& node : outcome.nodes) {
        const json report = json::parse(node.json, nullptr, false);
        if (report.is_object() && report.contains("resets")) add_lines(node.name, report["resets"], lines);
    }
    std::string text;
    for (std::size_t i = 0; i < lines.size() && i < kShownResets; ++i)
        text += "\n" + lines[i];
    if (lines.size() > kShownResets)
        text += fmt::format("\nreset: and {} more in report.json", lines.size() - kShownResets);
    return text;
}

}  // namespace puckloop::tools
