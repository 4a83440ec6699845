#pragma once
// The discrepancies of a posterior-predictive check: curves of one observable's residuals, at places that the
// measured residuals fix.

#include "gap/findings/predictive.h"
#include "gap/models/model.h"
#include "gap/stats/structure.h"

#include <functional>
#include <vector>

namespace puckloop::gap {

/// Do curves of means and sizes of an observable count in the decision? Sums have tests of their own: where
/// their errors are next to none replicates differ by rounding alone. Of what happens or not a rare one more
/// is farther than any replicate goes, by chance. (How large errors are, the marginal law, and how they carry
/// over is the noise's business and never counts.)
bool is_replicated(const Observable& observable);

struct Discrepancy {
    PredictiveCurve curve;  ///< envelope and p value still missing
    /// The curve's values for the residuals of all rows.
    std::function<std::vector<double>(const std::vector<double>& residuals)> values_of{};
    std::vector<std::vector<double>> replicated{};  ///< its values, a data set each

    /// The curve with the envelope and p value of the replicated values.
    PredictiveCurve judged() const;
};

/// Marginal law, autocorrelation, means against each of the covariates (a value a row), spread per run.
/// `observable` must outlive them.
std::vector<Discrepancy> discrepancies_of(const Observable& observable, const std::vector<double>& measured,
                                          const std::vector<stats::Covariate>& covariates,
                                          const std::string& residual);

}  // namespace puckloop::gap
