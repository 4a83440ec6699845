#include "reproductions/ears_radio.h"

#include "base/error.h"
#include "reproductions/pictures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace puckloop::tools {

namespace {

constexpr double kRadioField = 0.6, kRadioCorner = 0.2;  // m
constexpr double kStands = 0.0005;                       // m: points closer than that are one
/// Simulated time for a second of the walk at most: each exchange of 20 s has five seconds of silence behind
/// it, in which it walks.
constexpr double kShare = 5.5, kRadioStart = 10.0;
constexpr int kCaller = 1234, kWalker = 1;

}  // namespace

EarsRadio read_walk(const std::vector<RobotLine>& lines, double walk_s, double end) {
    EarsRadio ears;
    double began = -1.0;  // the stretch of the walk
    std::vector<RobotLine> exchange;
    RadioAttempt attempt;
    for (const RobotLine& line : lines) {
        exchange.push_back(line);
        if (line.text.starts_with("hears ") && began >= 0) {
            const double walked = ears.walked + line.seconds - began;
            if (walked > walk_s) break;
            ears.walked = attempt.walked = walked;
            ears.lasted = attempt.heard.seconds = line.seconds;
            attempt.volume = std::strtod(line.text.c_str() + 6, nullptr);
            began = -1.0;
            exchange.clear();
        } else if (line.text == "walks") {
            if (attempt.heard.seconds > 0) {
                const auto ended = read_exchanges(exchange);
                if (ended.size() != 1)
                    throw RunError(
                        fmt::format("{} exchanges were reported where one was under way at {:.3f} s",
                                    ended.size(), attempt.heard.seconds));
                attempt.exchange = ended.front();
                ears.attempts.push_back(attempt);
                attempt = {};
            }
            ears.lasted = began = line.seconds;
        }
    }
    if (began >= 0) {  // the rest of the walk, without a sound
        const double rest = std::min(walk_s - ears.walked, end - began);
        ears.walked += rest;
        ears.lasted += rest;
    }
    return ears;
}

EarsRadio ears_with_radio(const SoundOptions& options) {
    TrialSpec spec;
    spec.folder = options.folder / "radio";
    spec.seed = options.seed * 1000;
    spec.overlay = options.overlay;
    spec.arena = kRadioField;
    spec.seconds = kRadioStart + kShare * options.walk_s;
    spec.robots = {{"R", options.walker, 0.0, 0.0, 0.0, 0, {}, kCaller},
                   {"E", options.walker, -kRadioCorner, -kRadioCorner, 0.0, 1, {}, kWalker}};
    const Trial run = run_trial(spec);
    if (std::none_of(run.lines.at(1).begin(), run.lines.at(1).end(),
                     [](const RobotLine& line) { return line.text == "walks"; }))
        throw RunError(
            "the walker did not report on UART2 that it walks: the image must do as firmware/ears");
    EarsRadio ears = read_walk(run.lines.at(1), options.walk_s, spec.seconds);
    for (RadioAttempt& one : ears.attempts) {
        const auto where = run.at(1, one.heard.seconds);
        one.heard.x = where.x;
        one.heard.y = where.y;
    }
    for (const auto& point : run.paths.at(1)) {
        if (point.seconds > ears.lasted) break;
        const bool stands = !ears.path.empty() &&
                            std::hypot(point.x - ears.path.back().x, point.y - ears.path.back().y) < kStands;
        if (!stands) ears.path.push_back(point);
    }
    for (const RobotLine& line : run.lines.at(0))
        if (line.text == "heard I hear you" && line.seconds <= ears.lasted) ++ears.messages;
    return ears;
}

std::string ears_radio_csv(const EarsRadio& ears) {
    std::string csv = "t_s,walked_s,x_m,y_m,volume,outcome,exchange_s\n";
    for (const RadioAttempt& one : ears.attempts)
        csv += fmt::format("{:.3f},{:.3f},{:.4f},{:.4f},{:g},{},{}\n", one.heard.seconds, one.walked,
                           one.heard.x, one.heard.y, one.volume,
                           !one.exchange.failure.empty() ? one.exchange.failure
                           : one.exchange.answered       ? "answered"
                                                         : "no answer",
                           one.exchange.total ? fmt::format("{:.3f}", *one.exchange.total) : std::string());
    return csv;
}

std::string ears_radio_picture(const EarsRadio& ears, const std::string& caption) {
    Ears plain;
    plain.path = ears.path;
    std::vector<Heard> failed;
    for (const RadioAttempt& one : ears.attempts) {
        plain.heard.push_back(one.heard);
        if (!one.exchange.succeeded()) failed.push_back(one.heard);
    }
    return ears_picture(plain, caption, failed);
}

}  // namespace puckloop::tools
