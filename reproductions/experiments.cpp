#include "reproductions/experiments.h"

#include "base/error.h"
#include "base/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr double kMetresPerStep = 0.000128;  // fact sheet epuck.md: wheel of 41 mm, 1000 steps a turn
constexpr double kBooted = 0.5;              // s; every image answers by then

// Sound against distance
constexpr double kNear = 0.075, kFar = 0.300;  // m; the bodies touch at 0.074
constexpr double kDriveSpeed = 0.010;          // m/s
constexpr double kAskEvery = 0.05;             // s

// Ears and radio
constexpr double kField = 0.6, kCorner = 0.2;  // m; the corner is where a body has room to turn
constexpr double kCallEvery = 5.0;             // s

std::uint64_t seed_of(const SoundOptions& options, int trial) {
    return options.seed * 1000 + static_cast<std::uint64_t>(trial);
}

void ask(TrialRobot& robot, double from, double until, double every) {
    for (int i = 0; from + i * every < until; ++i)
        robot.commands.push_back({from + i * every, "U\r"});
}

/// The answers of robot `index`, with the time of each.
std::vector<Volumes> answers(const Trial& trial, std::size_t index) {
    std::vector<Volumes> found;
    for (const RobotLine& line : trial.lines.at(index)) {
        Volumes volumes;
        volumes.at = line.seconds;
        if (parse_volumes(line.text, volumes)) found.push_back(volumes);
    }
    if (found.empty())
        throw RunError("no robot answered the command U on UART1: the image must answer as BTcom does");
    return found;
}

TrialSpec spec_of(const SoundOptions& options, const std::string& name, int trial) {
    TrialSpec spec;
    spec.folder = options.folder / fmt::format("{}{}", name, trial);
    spec.seed = seed_of(options, trial);
    spec.overlay = options.overlay;
    return spec;
}

}  // namespace

bool parse_volumes(const std::string& line, Volumes& volumes) {
    int used = 0;
    auto& c = volumes.counts;
    return std::sscanf(line.c_str(), "u,%lf,%lf,%lf%n", &c[0], &c[1], &c[2], &used) == 3 &&
           static_cast<std::size_t>(used) == line.size();
}

Readings sound_against_distance(const SoundOptions& options, const TrialProgress& progress) {
    Readings readings;
    const double end = kFirstCall + (kFar - kNear) / kDriveSpeed;
    for (int trial = 0; trial < options.trials; ++trial) {
        if (progress) progress(trial, options.trials);
        TrialSpec spec = spec_of(options, "distance", trial);
        spec.seconds = end;
        TrialRobot caller{"caller", options.firmware, 0.0, 0.0, 0.0}, listener = caller;
        const double call = kCallWords[0] / kCallRate;
        for (double t = kBooted; t < end; t += call)
            caller.commands.push_back({t, "T,1\r"});
        listener.name = "listener";
        listener.x = kNear;  // it looks away from the caller and drives ahead
        const auto speed = std::lround(kDriveSpeed / kMetresPerStep);
        listener.commands.push_back({kFirstCall, fmt::format("D,{0},{0}\r", speed)});
        ask(listener, kFirstCall + kAskEvery, end, kAskEvery);
        spec.robots = {caller, listener};
        const Trial run = run_trial(spec);
        std::vector<Volumes> read = answers(run, 1);
        for (Volumes& one : read) {
            const auto here = run.at(1, one.at), there = run.at(0, one.at);
            one.at = std::hypot(here.x - there.x, here.y - there.y);
        }
        readings.push_back(std::move(read));
    }
    return readings;
}

Readings five_sounds(const SoundOptions& options, const TrialProgress& progress) {
    constexpr double kApart = 0.10;
    constexpr double kEnd = kFirstCall + kCalls * kCallSpacing;
    Readings readings;
    for (int trial = 0; trial < options.trials; ++trial) {
        if (progress) progress(trial, options.trials);
        TrialSpec spec = spec_of(options, "calls", trial);
        spec.seconds = kEnd;
        TrialRobot caller{"caller", options.firmware, 0.0, 0.0, 0.0}, listener = caller;
        for (int call = 0; call < kCalls; ++call)
            caller.commands.push_back({kFirstCall + call * kCallSpacing, fmt::format("T,{}\r", call + 1)});
        listener.name = "listener";
        listener.x = kApart;
        listener.heading = std::numbers::pi;  // they face each other
        ask(listener, kBooted, kEnd, 0.03);
        spec.robots = {caller, listener};
        readings.push_back(answers(run_trial(spec), 1));
    }
    return readings;
}

Ears ears_and_radio(const SoundOptions& options, const TrialProgress& progress) {
    if (progress) progress(0, 1);
    TrialSpec spec = spec_of(options, "ears", 0);
    spec.seconds = options.walk_s;
    spec.arena = kField;
    Ears ears;
    TrialRobot caller{"R", options.firmware, 0.0, 0.0, 0.0};
    for (double t = kBooted; t < options.walk_s; t += kCallEvery) {
        ++ears.calls;
        caller.commands.push_back({t, "T,5\r"});
    }
    TrialRobot walker{"E", options.walker, -kCorner, -kCorner, 0.0, 2};
    spec.robots = {caller, walker};
    const Trial run = run_trial(spec);
    for (const RobotLine& line : run.lines.at(1)) {
        const auto where = run.at(1, line.seconds);
        ears.heard.push_back({line.seconds, where.x, where.y});
    }
    ears.path = run.paths.at(1);
    return ears;
}

std::vector<Bin> binned(const Readings& readings, double width) {
    std::map<long, std::vector<double>> bins;
    for (const auto& trial : readings)
        for (const Volumes& one : trial)
            bins[std::lround(one.at / width)].push_back(one.mean());
    std::vector<Bin> result;
    for (auto& [number, values] : bins) {
        std::sort(values.begin(), values.end());
        result.push_back({static_cast<double>(number) * width, sorted_quantile(values, 0.1),
                          sorted_quantile(values, 0.5), sorted_quantile(values, 0.9),
                          static_cast<int>(values.size())});
    }
    return result;
}

}  // namespace puckloop::tools
