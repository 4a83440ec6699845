#include "run/nodes/linux_clocks.h"

#include "base/random.h"

#include <cstddef>

namespace puckloop::tools {

namespace {

constexpr double kMostError = 20.0;                                 // ppm
constexpr double kLeastOversleep = 60e-6, kMostOversleep = 100e-6;  // s
constexpr double kJitter = 30e-6;                                   // s

/// One of several robots' boards; a coordinator's computer is none.
bool is_one_of_several(const scenarios::Scenario& scenario, const std::string& name) {
    std::size_t boards = 0;
    bool found = false;
    for (const scenarios::RobotBoards& robot : scenario.robots) {
        if (!robot.linux_board) continue;
        ++boards;
        found = found || name == robot.name + ".linux";
    }
    return found && boards > 1;
}

}  // namespace

BoardClock draw_clock(std::uint64_t seed, const std::string& name) {
    RandomStream stream(seed, "clock." + name);
    BoardClock clock;
    clock.error_ppm = kMostError * (2 * stream.uniform() - 1);
    clock.oversleep = kLeastOversleep + (kMostOversleep - kLeastOversleep) * stream.uniform();
    clock.jitter = kJitter;
    return clock;
}

BoardClock clock_of(const scenarios::Scenario& scenario, const std::string& name,
                    const scenarios::LinuxBoard& board) {
    BoardClock clock;
    if (!scenario.ideal_linux_clocks && is_one_of_several(scenario, name))
        clock = draw_clock(scenario.seed, name);
    if (board.clock_ppm) clock.error_ppm = *board.clock_ppm;
    if (board.late.oversleep_stated) {
        clock.oversleep = board.late.oversleep;
        clock.jitter = board.late.oversleep_jitter;
    }
    return clock;
}

}  // namespace puckloop::tools
