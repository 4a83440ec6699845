#pragma once
// What is to be learnt of: errors of each observable, row by row, with the covariates that the world knows.

#include "gap/data/experiment.h"
#include "gap/models/model.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap {

/// What the world knows, a moment each.
struct WorldCovariate {
    std::string name, unit;
    std::vector<double> value;
    bool factor = false;    ///< a table may be a share of it
    bool periodic = false;  ///< an angle once round, -pi to pi
};

struct Subject {
    std::size_t observable = 0;           ///< in Model::observables()
    std::string quantity, quantity_unit;  ///< of the world; no name: it has no such place
    bool sums = false;                    ///< what a row gains goes on in all rows after it
    std::vector<double> error;            ///< measured - predicted; NaN: the instrument does not show it
    /// Where each row's moments begin, and where the last one's end: a reading has one, a row of a sum as
    /// many as what it gains may change in it, or none.
    std::vector<std::uint32_t> moments;
    std::vector<double> weight;  ///< of a moment: s in which the wheels were driven, or 1
    std::vector<std::uint32_t> run;
    std::vector<char> starts;
    std::vector<int> sensor;  ///< 0 where there is one
    int sensors = 1;          ///< that occur, highest number + 1
    std::vector<WorldCovariate> covariates;
};

/// Of every observable that a term can be learnt for: not of events, nor of counters of known noise. A
/// drive's are along, across and heading: `model` looks at it along the robot's axes.
std::vector<Subject> subjects_of(const Experiment& experiment, const Model& model,
                                 const std::vector<double>& values, const Prediction& prediction);

}  // namespace puckloop::gap
