#pragma once
// Do runs differ though nothing that was noted does? Beside a fitted model each run gets a number of its own,
// anew drawn from N(0, tau^2): an offset, a share of the prediction, a drift (random effects: Laird and Ware,
// Biometrics 38, 1982), beside what the simulator itself draws once a run (Observable::run_draws). And within
// a run: does the level jump once and stay (change points: Page, Biometrika 41, 1954; Hinkley 1970)?
//
// Both follow from score statistics of the innovations: g, their sum weighted with how each answers to the
// number, and h, its information. How far g scatters is taken from blocks inside the runs (batch means), so
// that errors that carry over longer than the noise model says raise no alarm.

#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// One way in which runs may differ, of one observable.
struct RunDifference {
    std::string observable;
    double gain = 0.0;     ///< log score of runs left out, over one number for all of them, nats
    double sd = 0.0;       ///< of the gain, between runs
    double p_value = 1.0;  ///< analysis of variance: runs against blocks inside runs
    std::string shape;     ///< in words: an offset, a share of the reading, a drift, with its size
};

/// The ways in which runs differ, the one that gains most first; none with fewer than three runs.
std::vector<RunDifference> run_differences(const Model& model, const State& state);

/// One jump that stays, inside a run.
struct ChangePoint {
    std::string observable;
    std::uint32_t run = 0, row = 0;
    double jump = 0.0;     ///< observable's unit
    double p_value = 1.0;  ///< that the highest of so many chains and observables is so high
    std::string shape;
};

/// The clearest jump of each observable, where one is to be seen; the surest first.
std::vector<ChangePoint> change_points(const Model& model, const State& state);

}  // namespace puckloop::gap
