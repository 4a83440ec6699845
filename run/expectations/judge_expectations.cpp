#include "run/expectations/judge_expectations.h"

#include "base/error.h"
#include "base/suggest.h"
#include "physics/render/path_file.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string_view>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using scenarios::Expectation;
using Kind = Expectation::Kind;

std::vector<std::string_view> names_for(const RunSetup& setup, Kind kind) {
    std::vector<std::string_view> names;
    if (kind == Kind::Line) {
        for (const cosim::LinkSpec& link : setup.links)
            if (link.nominal_baud > 0.0) names.push_back(link.name);
    } else if (kind == Kind::Place) {
        for (const auto& robot : setup.scenario.robots)
            names.push_back(robot.name);
    } else {
        for (const PlannedNode& node : setup.nodes)
            names.push_back(node.name);
    }
    return names;
}

constexpr const char* kWhat[]{"node", "serial line", "robot", "node"};

/// Whether something was seen that should be, or should not.
void decide(ExpectationResult& result, const Expectation& expected, bool seen) {
    result.met = seen == expected.seen;
}

void judge_log(ExpectationResult& result, const Expectation& expected, const RunSetup& setup) {
    const std::string name = expected.subject + ".log";
    std::ifstream log(setup.out / name, std::ios::binary);
    std::size_t number = 0, found = 0;
    for (std::string line; found == 0 && std::getline(log, line);) {
        ++number;
        if (line.find(expected.text) != std::string::npos) found = number;
    }
    result.why = found > 0    ? fmt::format("line {} of {} has it", found, name)
                 : number > 0 ? fmt::format("none of the {} lines of {} has it", number, name)
                              : fmt::format("{} is empty", name);
    decide(result, expected, found > 0);
}

void judge_line(ExpectationResult& result, const Expectation& expected, std::optional<double> seen) {
    result.at = seen;
    result.why = seen ? fmt::format("seen at {:.6f} s", *seen) : "not seen";
    decide(result, expected, seen.has_value());
}

void judge_place(ExpectationResult& result, const Expectation& expected, const physics::Paths& paths) {
    const auto path = std::find_if(paths.begin(), paths.end(),
                                   [&](const auto& one) { return one.first == expected.subject; });
    double nearest = std::numeric_limits<double>::infinity(), when = 0.0;
    if (path != paths.end()) {
        for (const physics::PathPoint& point : path->second) {
            if (point.seconds < expected.after || point.seconds > expected.by) continue;
            const double distance = expected.region.distance({point.x, point.y});
            if (distance < nearest) {
                nearest = distance;
                when = point.seconds;
            }
            if (nearest > 0.0) continue;
            result.at = when;
            break;
        }
    }
    result.why = result.at ? fmt::format("there at {:.3f} s", *result.at)
                 : std::isfinite(nearest)
                     ? fmt::format("nearest at {:.3f} s, {:.3f} m from it", when, nearest)
                     : "nothing was recorded in that time";
    decide(result, expected, result.at.has_value());
}

void judge_resets(ExpectationResult& result, const Expectation& expected, const cosim::Outcome& outcome) {
    for (const auto& node : outcome.nodes) {
        if (node.name != expected.subject) continue;
        const json report = json::parse(node.json, nullptr, false);
        if (!report.is_object() || !report.contains("resets")) break;
        const json& resets = report["resets"];
        result.met = resets.size() <= 1;
        result.why = "one start";
        if (result.met) return;
        result.at = resets[1].value("time_s", 0.0);
        result.why = fmt::format("reset at {:.6f} s ({})", *result.at, resets[1].value("cause", "no cause"));
        return;
    }
    result.why = "the node reported no resets";
}

/// The world's record; of a run that did not begin there is none.
physics::Paths paths_of(const RunSetup& setup) {
    try {
        return physics::read_paths(setup.out / "trajectory.csv");
    } catch (const RunError&) {
        return {};
    }
}

}  // namespace

void check_expectations(const RunSetup& setup) {
    const auto check = [&](const Expectation& expected, const std::string& name, Kind kind) {
        const auto known = names_for(setup, kind);
        if (std::find(known.begin(), known.end(), name) != known.end()) return;
        const char* what = kWhat[static_cast<std::size_t>(kind)];
        throw InputError(setup.scenario.file.string(), expected.place,
                         fmt::format("expect: there is no {} '{}'", what, name),
                         fmt::format("a {} of the run{}", what, did_you_mean(name, known)));
    };
    for (const Expectation& expected : setup.scenario.expectations) {
        check(expected, expected.subject, expected.kind);
        if (expected.kind == Kind::Line && !expected.from.empty()) check(expected, expected.from, Kind::Log);
    }
}

std::vector<ExpectationResult> judge_expectations(const RunSetup& setup, const cosim::Outcome& outcome,
                                                  const LineWatch& lines) {
    const std::vector<Expectation>& all = setup.scenario.expectations;
    const bool places =
        std::any_of(all.begin(), all.end(), [](const Expectation& one) { return one.kind == Kind::Place; });
    const physics::Paths paths = places ? paths_of(setup) : physics::Paths{};
    std::vector<ExpectationResult> results;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Expectation& expected = all[i];
        ExpectationResult result{
            .name = expected.name, .place = expected.place, .subject = expected.subject, .why = {}};
        switch (expected.kind) {
        case Kind::Log:
            judge_log(result, expected, setup);
            break;
        case Kind::Line:
            judge_line(result, expected, lines.seen_at(i));
            break;
        case Kind::Place:
            judge_place(result, expected, paths);
            break;
        case Kind::NoReset:
            judge_resets(result, expected, outcome);
            break;
        }
        results.push_back(std::move(result));
    }
    return results;
}

std::string unmet_text(const ExpectationResult& result) {
    return fmt::format("expected that {}: {}", result.name, result.why);
}

void fail_unmet(const RunSetup& setup, const std::vector<ExpectationResult>& results,
                std::vector<Failure>& failures, cosim::Outcome& outcome) {
    for (const ExpectationResult& result : results) {
        if (result.met) continue;
        const std::string text = unmet_text(result);
        failures.push_back({result.subject, "expectation", text, false});
        if (!outcome.success) continue;
        outcome.success = false;
        outcome.node = result.subject;
        outcome.text = fmt::format("{}: {}: {}", setup.scenario.file.string(), result.place, text);
    }
}

}  // namespace puckloop::tools
