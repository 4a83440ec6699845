#include "run/expectations/plan_expectations.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "traces/decoders/decode.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

namespace puckloop::tools {

namespace {

using scenarios::Expectation;
using Kind = Expectation::Kind;

/// What a table's name is looked for among.
struct Names {
    const char* what;
    std::vector<std::string_view> known;
};

Names node_names(const RunSetup& setup, bool boards) {
    Names names{boards ? "board" : "node", {}};
    for (const PlannedNode& node : setup.nodes)
        if (!boards || has_board(node.what)) names.known.push_back(node.name);
    return names;
}

Names names_for(const RunSetup& setup, Kind kind) {
    Names names{"robot", {}};
    switch (kind) {
    case Kind::Log:
        return node_names(setup, false);
    case Kind::NoReset:
    case Kind::Value:
        return node_names(setup, true);
    case Kind::Line:
    case Kind::NoLoss:
        names.what = "serial line";
        for (const cosim::LinkSpec& link : setup.links)
            if (link.nominal_baud > 0.0) names.known.push_back(link.name);
        break;
    case Kind::Place:
        for (const auto& robot : setup.scenario.robots)
            names.known.push_back(robot.name);
        break;
    case Kind::Frame:
        return {"protocol", {kProtocols.begin(), kProtocols.end()}};
    }
    return names;
}

/// Who may send what is expected: of a line its two ends.
Names senders(const RunSetup& setup, const Expectation& expected) {
    if (expected.kind != Kind::Line) return node_names(setup, false);
    Names names{"end of that line", {}};
    for (const cosim::LinkSpec& link : setup.links)
        if (link.name == expected.subject) names.known = {link.a.node, link.b.node};
    return names;
}

void check(const RunSetup& setup, const Expectation& expected, const std::string& name, const Names& names) {
    constexpr std::size_t kShown = 12;
    if (std::find(names.known.begin(), names.known.end(), name) != names.known.end()) return;
    std::vector<std::string_view> shown = names.known;
    if (shown.size() > kShown) shown.resize(kShown);
    throw InputError(setup.scenario.file.string(), expected.place,
                     fmt::format("expect: there is no {} '{}'", names.what, name),
                     shown.empty() ? fmt::format("the run has no {}", names.what)
                                   : fmt::format("one of {}{}{}", fmt::join(shown, ", "),
                                                 shown.size() < names.known.size() ? ", ..." : "",
                                                 did_you_mean(name, names.known)));
}

cosim::Time instant(double seconds) {
    return std::isfinite(seconds) ? cosim::from_seconds(seconds) : cosim::kNever;
}

void watch(RunSetup& setup, const RunRequest& request, const Expectation& expected) {
    if (!request.from_state.empty() || !request.save_state.empty())
        throw InputError(setup.scenario.file.string(), expected.place,
                         "expect: a value of a board is not looked for in a run with saved states of boards",
                         "a run that begins at power-up, or from a snapshot");
    for (PlannedNode& node : setup.nodes) {
        if (node.name != expected.subject) continue;
        node.what.care.watches.push_back({setup.scenario.file.string(), expected.place, expected.text,
                                          instant(expected.after), instant(expected.by),
                                          instant(expected.every)});
        node.what.care.from_state.reset();  // of the boot cache
        node.what.care.save_state.reset();
    }
}

}  // namespace

void plan_expectations(RunSetup& setup, const RunRequest& request) {
    for (const Expectation& expected : setup.scenario.expectations) {
        check(setup, expected, expected.subject, names_for(setup, expected.kind));
        if (!expected.from.empty()) check(setup, expected, expected.from, senders(setup, expected));
        if (expected.kind == Kind::Value) watch(setup, request, expected);
    }
}

}  // namespace puckloop::tools
