#include "run/mission/mission_lines.h"

#include "base/error.h"
#include "base/json.h"
#include "base/plain_text.h"
#include "base/text/suggest.h"
#include "scenarios/reader/events/event_tables.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

namespace puckloop::tools {

using nlohmann::ordered_json;

namespace {

constexpr std::array<std::string_view, 3> kAnswerKeys{"act", "end", "score"};
constexpr std::size_t kShownLine = 80, kLongestReason = 200;

/// Of a time, place or heading no more digits than mean anything: milliseconds, 10 um, 0.1 mrad.
constexpr double kPerSecond = 1e3, kPerMetre = 1e5, kPerRadian = 1e4;
double rounded(double value, double per_unit) {
    return std::round(value * per_unit) / per_unit;
}

ordered_json pose(const std::string& name, double x, double y, double heading) {
    return {{"name", name},
            {"x_m", rounded(x, kPerMetre)},
            {"y_m", rounded(y, kPerMetre)},
            {"theta_rad", rounded(heading, kPerRadian)}};
}

double seconds_of_step(std::uint64_t step) {
    return static_cast<double>(step) / 1000.0;
}

void read_act(const ordered_json& value, MissionReply& reply) {
    const auto act = [&](const ordered_json& text) {
        if (!text.is_string())
            throw InputError("", "act", plain_text(text.dump(), kShownLine) + " is no command", "a text");
        reply.answer.acts.push_back(scenarios::parse_command(text.get<std::string>()));
    };
    if (!value.is_array()) return act(value);
    for (const ordered_json& text : value)
        act(text);
}

void read_end(const ordered_json& value, MissionReply& reply) {
    if (value.is_boolean()) {
        reply.answer.end = value.get<bool>();
        if (reply.answer.end) reply.answer.why = "the mission program ended the run";
    } else if (value.is_string()) {
        reply.answer.end = true;
        reply.answer.why = "the mission program: " + plain_text(value.get<std::string>(), kLongestReason);
    } else {
        throw InputError("", "end", plain_text(value.dump(), kShownLine) + " ends nothing",
                         "true, false or a reason");
    }
}

}  // namespace

std::string begin_line(const physics::World& world, const physics::TrackerSpec& tracker,
                       std::optional<double> duration) {
    ordered_json line{{"begin", kMissionProtocol},
                      {"seed", world.seed},
                      {"duration_s", duration ? ordered_json(*duration) : ordered_json()},
                      {"frame_rate_hz", tracker.frame_rate},
                      {"latency_s", tracker.latency},
                      {"arena_m", ordered_json::array()},
                      {"robots", ordered_json::array()}};
    for (const physics::Point& corner : world.arena.corners)
        line["arena_m"].push_back({rounded(corner.x, kPerMetre), rounded(corner.y, kPerMetre)});
    for (const physics::Robot& robot : world.robots)
        line["robots"].push_back(pose(robot.name, robot.x, robot.y, robot.heading));
    return line.dump() + "\n";
}

std::string frame_line(const physics::TrackerFrame& frame, const std::vector<std::string>& names,
                       std::span<const physics::Journal::Entry> done,
                       std::span<const physics::RefusedCommand> refused) {
    ordered_json line{{"frame", frame.number},
                      {"t_s", seconds_of_step(frame.step)},
                      {"arrives_s", seconds_of_step(frame.arrives)},
                      {"robots", ordered_json::array()},
                      {"events", ordered_json::array()}};
    for (const physics::TrackedRobot& robot : frame.robots)
        line["robots"].push_back(pose(names[robot.robot], robot.x, robot.y, robot.heading));
    for (const physics::Journal::Entry& entry : done) {
        ordered_json event{
            {"at_s", physics::in_seconds(entry.time)}, {"event", entry.event}, {"act", entry.command}};
        if (!entry.refused.empty()) event["refused"] = entry.refused;
        line["events"].push_back(std::move(event));
    }
    for (const physics::RefusedCommand& command : refused)
        line["events"].push_back({{"at_s", physics::in_seconds(command.time)},
                                  {"event", "command"},
                                  {"act", command.command},
                                  {"refused", command.why}});
    return line.dump() + "\n";
}

std::string end_line(double seconds) {
    return ordered_json{{"end", rounded(seconds, kPerSecond)}}.dump() + "\n";
}

MissionReply read_reply(std::string_view line) {
    const ordered_json json = ordered_json::parse(line, nullptr, false);
    if (!json.is_object())
        throw InputError("", "",
                         fmt::format("'{}' is no JSON object", plain_text(std::string(line), kShownLine)),
                         "a line such as {\"score\": 3}");
    MissionReply reply;
    for (const auto& [key, value] : json.items()) {
        if (key == "act") {
            read_act(value, reply);
        } else if (key == "end") {
            read_end(value, reply);
        } else if (key == "score") {
            if (!value.is_number() || !std::isfinite(value.get<double>()))
                throw InputError("", "score", plain_text(value.dump(), kShownLine) + " is no score",
                                 "a number");
            reply.score = value.get<double>();
        } else {
            throw InputError("", "",
                             fmt::format("'{}' is no key of an answer{}", plain_text(key, kShownLine),
                                         did_you_mean(key, {kAnswerKeys.begin(), kAnswerKeys.end()})),
                             "act, end, score");
        }
    }
    return reply;
}

}  // namespace puckloop::tools
