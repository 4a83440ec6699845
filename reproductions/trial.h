#pragma once
// One run of robots that make and hear sound or talk by Bluetooth: from its robots to what they wrote.

#include "physics/render/path_file.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::tools {

/// Bytes that reach a robot at a time.
struct ScriptLine {
    double seconds = 0.0;
    std::string text;
};

struct TrialRobot {
    std::string name;
    std::filesystem::path firmware;
    double x = 0.0, y = 0.0, heading = 0.0;  ///< m, rad
    int selector = 0;
    std::vector<ScriptLine> commands{};  ///< to UART1, or with Bluetooth to UART2; its lines come from there
    int bluetooth = 0;                   ///< number of its module, on UART1; 0: none
};

struct TrialSpec {
    std::filesystem::path folder;  ///< of the scenario and its results; made anew
    double seconds = 0.0;
    double arena = 2.0;  ///< side, m
    std::uint64_t seed = 1;
    std::filesystem::path overlay{};  ///< physical parameters; empty: none
    std::vector<TrialRobot> robots;
};

/// A line that a robot wrote, without its end, and when its first character was on the wire.
struct RobotLine {
    double seconds = 0.0;
    std::string text;
};

struct Trial {
    std::vector<std::vector<RobotLine>> lines;           ///< of each robot
    std::vector<std::vector<physics::PathPoint>> paths;  ///< of each robot, 10 a second and more

    /// Where a robot was, between two points on a straight line.
    physics::PathPoint at(std::size_t robot, double seconds) const;
};

/// Writes the scenario, runs it in this process and reads what it left. Throws InputError for what the
/// scenario reader refuses (an image, a parameter), RunError where the run did not reach its end.
Trial run_trial(const TrialSpec& spec);

}  // namespace puckloop::tools
