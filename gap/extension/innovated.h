#pragma once
// Errors as innovations, each with its weight by Student's law.

#include "gap/extension/learning_rows.h"

#include <Eigen/Dense>

#include <vector>

namespace puckloop::gap {

struct Innovated {
    Eigen::VectorXd z, weight;
    double squares = 0.0, rows = 0.0, log_sizes = 0.0;

    /// ln likelihood with the size fitted, but for a constant, where so much of the squares is left.
    double score(double squares_left) const;
};

Innovated innovated(const LearningRows& rows, const std::vector<double>& error, const ErrorsLaw& law,
                    const Whitening& whitening);

}  // namespace puckloop::gap
