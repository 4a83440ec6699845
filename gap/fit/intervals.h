#pragma once
// How well the data fixes the fitted parameters.

#include "gap/fit/study.h"

#include <Eigen/Core>

#include <vector>

namespace puckloop::gap {

/// sd of each freed parameter of a fit (its own unit), from the rows' information and from what fits without
/// one block of rows would say; and how far each is fixed by the others.
struct Precision {
    std::vector<double> sd;
    double quantile = 1.645;      ///< of the 90 % interval, for the number of blocks
    Eigen::MatrixXd correlation;  ///< of the freed parameters
};
Precision precision_of(const Study& study, const Fit& fit);

/// The 90 % interval of the fit's freed parameter `j`, within its plausible range.
struct Interval {
    double low = 0.0, high = 0.0;
    std::vector<double> as_likely;  ///< single values apart from the fitted one that fit as well, rising
};
Interval interval_of(const Study& study, const Fit& fit, const Precision& precision, std::size_t j);

}  // namespace puckloop::gap
