#pragma once
// What a hidden effect depends on, drawn at random: products and compositions of elementary functions of
// whatever varies in an experiment, for some wheels, sensors, runs or times only. Knows nothing of the
// analysis.

#include "base/random.h"
#include "gap/data/written.h"

#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap::selftest::grammar {

/// A value for every row of every run.
using Rows = std::vector<std::vector<double>>;

/// Something that varies over the rows. Divided by its largest size: zero stays zero.
struct Covariate {
    std::string name;
    Rows value;
};

/// All that vary in an exact experiment: its columns, what follows from a drive's poses and counters, and the
/// level that is measured. Columns that only number something are left out.
std::vector<Covariate> covariates_of(const WrittenExperiment& exact);
/// Column that numbers sensors, microphones or receivers; "" where the kind has none.
std::string index_column(const WrittenExperiment& exact);

struct Field {
    Rows value;        ///< root mean square 1
    std::string text;  ///< the expression, for the record
};

/// Draws until something comes out that varies and is not zero nearly everywhere.
Field drawn_field(const WrittenExperiment& exact, const std::vector<Covariate>& covariates,
                  RandomStream& random);

/// sign(z) |z|^exponent of one covariate, nothing else.
Field power_of(const Covariate& covariate, double exponent);

}  // namespace puckloop::gap::selftest::grammar
