#pragma once
// How many measured runs does a mission's comparison need? Asked of the experiment's own runs, before anybody
// measures a robot.
//
// The means of each condition, and the scatter of single runs about them (residuals of all conditions of a
// program, drawn with replacement, a whole run at a time), are taken for the truth. From it both sides of a
// comparison are drawn: as many simulated runs as there are, and the measured ones, with an effect hidden in
// them. What chance has added to the difference of two conditions' means counts as effect: with few simulated
// runs of a small one the curves are too good.

#include "gap/mission/runs.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap::mission {

struct PowerRequest {
    std::vector<std::size_t> runs{4, 8, 16, 32};  ///< of each program, at least 2; rising
    std::size_t cases = 40;                       ///< drawn for each number of runs and each effect
    double share = 1.0;                           ///< of what the condition changes is hidden
    std::uint64_t seed = 1;
    /// Called after each number of runs of each effect.
    std::function<void(std::size_t done, std::size_t of)> progress{};
};

/// Of one effect, or of nothing hidden, at one number of runs.
struct PowerPoint {
    std::size_t runs = 0;
    int cases = 0;
    int right = 0;  ///< named, and it is the one; of nothing hidden: no difference is shown
    int wrong = 0;  ///< another one is named first; of nothing hidden: any
    int open = 0;   ///< a difference is shown, and no name for sure
    int same = 0;   ///< no difference is shown
};

struct PowerCurve {
    std::string effect;  ///< empty: nothing is hidden
    std::vector<PowerPoint> points;
};

struct Power {
    PowerRequest request;
    std::vector<PowerCurve> curves;  ///< the effects in their order, nothing last
    std::size_t programs = 0;
    std::size_t simulated_runs = 0;
};

/// Throws InputError: an experiment with one condition, or fewer than four runs of a program under one.
Power power_of(const MissionRuns& simulated, const PowerRequest& request);

/// For a terminal: a table, and for each effect the first number of runs that names it in 8 of 10.
std::string power_text(const Power& power);
/// A row for each effect and number of runs.
std::string power_csv(const Power& power);
/// Share rightly named against runs.
std::string power_svg(const Power& power);

}  // namespace puckloop::gap::mission
