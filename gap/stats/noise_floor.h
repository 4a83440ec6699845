#pragma once
// How well anything could be predicted: the scatter among repeats of the same stimulus.

#include "gap/stats/series.h"

#include <vector>

namespace puckloop::gap::stats {

struct NoiseFloor {
    double within_run = 0.0;    ///< deviation of repeats inside a run about their mean; NaN without repeats
    double between_runs = 0.0;  ///< deviation of the means of one stimulus from run to run; NaN without such
};

/// `stimulus`: rows with equal numbers got the same stimulus (see stimulus_numbers); negative: none known.
NoiseFloor noise_floor(const Series& measured, const std::vector<int>& stimulus);

/// Deviation of single rows, from second differences of what a model leaves: no repeats are needed, and what
/// changes from row to row is taken out as far as the model has it. Only rows of one run and one `chain`
/// (sensor, receiver; in the order of rows) follow each other. NaN if short.
double row_to_row(const Series& left, const std::vector<int>& chain);

/// Equal numbers for rows whose covariates are all equal (within the share `same` of each one's range); -1
/// where one is not known.
std::vector<int> stimulus_numbers(const std::vector<std::vector<double>>& covariates, double same = 1e-9);

}  // namespace puckloop::gap::stats
