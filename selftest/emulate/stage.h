#pragma once
// One recorded run on the emulator: an arena, a robot with firmware and the program puckloop-record on its
// Linux board, a tracker above. What comes back is what a laboratory would have.
//
// Deviations: 1. the tracker samples when the Linux board sends; its noise is white. 2. Accelerometer and
// microphones are in the project's own firmware's record only; another's says 0.

#include "linuxboard/record/command_script.h"
#include "scenarios/reader/scenario.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace puckloop::gap::emulate {

/// What stands in for the robot on the table. Parameters are those of `run --list-parameters`.
struct Robot {
    std::map<std::string, double> parameters;
    double crystal_ppm = 0.0;  ///< of the main board
    double period = 0.1;       ///< s between two exchanges of the Linux program
    double uart_factor = 1.0;  ///< bit time of the main board's frames over nominal
    double uart_loss = 0.0;    ///< probability that a byte to the Linux board is lost
    double uart_delay = 0.0;   ///< s by which bytes from the Linux board come later
    double uart_cut = 0.0;     ///< probability that an answer is cut; then, that the next one is too
    double uart_cut_again = 0.0;
    double uart_edge_loss = 0.0;        ///< probability that a byte 0x00 or 0xFF to the Linux board is lost
    scenarios::LinuxDelays lateness{};  ///< of the Linux board
    double rab_poll = 0.0;  ///< s between two polls of a range-and-bearing board; 0: until none waits
    /// s: the tracker's pose is the mean over so long, centred on the row's time. What is fitted has no blur.
    double tracker_exposure = 0.0;
    std::filesystem::path firmware;  ///< empty: the project's own
    std::filesystem::path rab;       ///< image for the range-and-bearing boards; empty: the project's own
    std::filesystem::path overlay;   ///< as for `run --model`; empty: none
};

/// What happens in one run.
struct Act {
    std::map<std::string, std::string> conditions;
    std::string arena;  ///< TOML: [arena], [[box]], [[floor_patch]], [light] ...
    double x = 0.0, y = 0.0, heading = 0.0;
    std::vector<control::ScriptedCommand> commands;  ///< the last one ends the run
    bool ground = false;
    double load = 0.0;                    ///< kg laid on the robot, known to the laboratory
    double slope_x = 0.0, slope_y = 0.0;  ///< rad that the table is tilted, known as well
    bool shimmed = false;   ///< no play under the skids: the robot does not rock, its tilt is the table's
    int ground_every = 1;   ///< exchanges from one reading of the ground sensors to the next
    bool relative = false;  ///< the program's periods count from the start of the one before
};

/// One exchange between Linux board and main board, and where the tracker saw the robot when it was begun.
struct Row {
    double t, answered;  ///< s since the Linux board's program began; NaN if not answered
    double powered;      ///< s since power came, from which on what warms up does
    double left, right;  ///< steps/s commanded
    double x, y, theta;  ///< true pose
    bool ok;
    double ps[8], amb[8], gs[3], acc[3], mic[3];  ///< NaN where not read
};

/// Programs and firmware of the project.
struct Tools {
    std::filesystem::path record, firmware, rab;  ///< recorder, main board's and range-and-bearing board's
};

/// Runs in `scratch` (made, left behind). Throws RunError when the run fails or most exchanges are not
/// answered.
std::vector<Row> perform(const Robot& robot, const Act& act, const Tools& tools, std::uint64_t seed,
                         const std::filesystem::path& scratch);

}  // namespace puckloop::gap::emulate
