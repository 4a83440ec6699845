#include "run/expectations/judge_expectations.h"

#include "base/error.h"
#include "base/json.h"
#include "physics/render/path_file.h"
#include "run/expectations/judge_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <map>
#include <utility>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using scenarios::Expectation;
using Kind = Expectation::Kind;

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

void judge_line(ExpectationResult& result, const Expectation& expected, const LineWatch& lines,
                std::size_t index) {
    result.at = lines.seen_at(index);
    result.why =
        result.at ? fmt::format("seen at {:.6f} s", *result.at) : "not seen: " + lines.what_came(index);
    decide(result, expected, result.at.has_value());
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

/// Null: the node could not report.
json report_of(const cosim::Outcome& outcome, const std::string& name) {
    for (const auto& node : outcome.nodes)
        if (node.name == name) return json::parse(node.json, nullptr, false);
    return {};
}

void judge_resets(ExpectationResult& result, const Expectation& expected, const cosim::Outcome& outcome) {
    const json report = report_of(outcome, expected.subject);
    if (!report.is_object() || !report.contains("resets")) {
        result.why = "the node reported no resets";
        return;
    }
    const json& resets = report["resets"];
    result.met = resets.size() <= 1;
    result.why = "one start";
    if (result.met) return;
    result.at = resets[1].value("time_s", 0.0);
    result.why = fmt::format("reset at {:.6f} s ({})", *result.at, resets[1].value("cause", "no cause"));
}

/// `number`: of the board's watches.
void judge_value(ExpectationResult& result, const Expectation& expected, const cosim::Outcome& outcome,
                 std::size_t number) {
    const json report = report_of(outcome, expected.subject);
    if (!report.is_object() || !report.contains("watches") || report["watches"].size() <= number) {
        result.why = "the board could not report";
        return;
    }
    const json& watch = report["watches"][number];
    if (watch.contains("seen_s")) result.at = watch["seen_s"].get<double>();
    const std::string last = watch.contains("last")
                                 ? fmt::format("{} (0x{:x})", watch["last"].get<std::uint64_t>(),
                                               watch["last"].get<std::uint64_t>())
                                 : "";
    result.why = result.at      ? fmt::format("it was {} at {:.6f} s", last, *result.at)
                 : last.empty() ? "the run ended before the first look"
                                : fmt::format("it was {} at {:.6f} s, the last look", last,
                                              watch["last_s"].get<double>());
    decide(result, expected, result.at.has_value());
}

/// What a receiver counts of characters that did not come as they were sent.
std::string losses_at(const json& counters) {
    std::string text;
    for (const char* what : {"framing_errors", "parity_errors", "overruns", "buffer_overruns", "overflow",
                             "while_down", "while_asleep"}) {
        const auto count = counters.value(what, std::uint64_t{0});
        std::string words = what;
        std::replace(words.begin(), words.end(), '_', ' ');
        if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, words);
    }
    return text;
}

void judge_loss(ExpectationResult& result, const Expectation& expected, const cosim::Outcome& outcome) {
    std::vector<std::string> lost;
    for (const auto& link : outcome.links) {
        if (link.name != expected.subject) continue;
        for (const auto& [from, stats] :
             {std::pair{&link.a, &link.from_a}, std::pair{&link.b, &link.from_b}}) {
            if (stats->faults > 0)
                lost.push_back(fmt::format("{} from {} harmed by faults", stats->faults, *from));
            if (stats->uart_off_rate > 0)
                lost.push_back(fmt::format("{} from {} at another rate", stats->uart_off_rate, *from));
        }
        for (const std::string& end : {link.a, link.b}) {
            const std::size_t dot = end.rfind('.');
            const json report = report_of(outcome, end.substr(0, dot));
            const std::string port = end.substr(dot + 1);
            if (!report.is_object() || !report.contains(port) || !report[port].is_object()) continue;
            if (const std::string at = losses_at(report[port]); !at.empty()) lost.push_back(end + ": " + at);
        }
    }
    result.met = lost.empty();
    result.why = lost.empty() ? "nothing was lost" : fmt::format("{}", fmt::join(lost, "; "));
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

std::vector<ExpectationResult> judge_expectations(const RunSetup& setup, const cosim::Outcome& outcome,
                                                  const LineWatch& lines) {
    const std::vector<Expectation>& all = setup.scenario.expectations;
    const bool places =
        std::any_of(all.begin(), all.end(), [](const Expectation& one) { return one.kind == Kind::Place; });
    const physics::Paths paths = places ? paths_of(setup) : physics::Paths{};
    std::map<std::string, std::size_t> watches;  // so many of the board's were judged
    std::vector<ExpectationResult> results;
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Expectation& expected = all[i];
        ExpectationResult result{.name = expected.name,
                                 .stated = expected.stated,
                                 .place = expected.place,
                                 .subject = expected.subject,
                                 .why = {}};
        switch (expected.kind) {
        case Kind::Log:
            judge_log(result, expected, setup);
            break;
        case Kind::Line:
            judge_line(result, expected, lines, i);
            break;
        case Kind::Place:
            judge_place(result, expected, paths);
            break;
        case Kind::NoReset:
            judge_resets(result, expected, outcome);
            break;
        case Kind::Value:
            judge_value(result, expected, outcome, watches[expected.subject]++);
            break;
        case Kind::NoLoss:
            judge_loss(result, expected, outcome);
            break;
        case Kind::Frame:
            break;  // all of them below
        }
        results.push_back(std::move(result));
    }
    judge_frames(setup.out, all, results);
    return results;
}

std::string unmet_text(const ExpectationResult& result) {
    return fmt::format("expected that {}{}: {}", result.name,
                       result.stated.empty() ? "" : fmt::format(" ({})", result.stated), result.why);
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
        const auto more =
            std::count_if(results.begin(), results.end(), [](const auto& one) { return !one.met; }) - 1;
        if (more > 0) outcome.text += fmt::format(" (and {} more of {} are not met)", more, results.size());
    }
}

}  // namespace puckloop::tools
