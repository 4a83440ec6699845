#pragma once
// The discrepancies of a posterior-predictive check: curves of one observable's residuals, at places that the
// measured residuals fix.

#include "gap/models/model.h"
#include "gap/predictive/predictive.h"
#include "gap/stats/structure.h"

#include <cstddef>
#include <vector>

namespace puckloop::gap {

/// Do curves of means and sizes of an observable count in the decision? Sums have tests of their own: where
/// their errors are next to none replicates differ by rounding alone. Of what happens or not a rare one more
/// is farther than any replicate goes, by chance. (How large errors are, the marginal law, and how they carry
/// over is the noise's business and never counts.)
bool is_replicated(const Observable& observable);

class Discrepancies {
  public:
    /// Marginal law, autocorrelation, means against each of the covariates (a value a row), spread per run.
    /// `observable` must outlive it.
    Discrepancies(const Observable& observable, const std::vector<double>& measured,
                  const std::vector<stats::Covariate>& covariates, const std::string& residual);

    /// Values of each curve at its places; `residuals` of all rows.
    std::vector<std::vector<double>> values_of(const std::vector<double>& residuals) const;
    /// All curves with the envelopes and p values of replicated residuals' values.
    std::vector<PredictiveCurve>
    curves(const std::vector<double>& measured,
           const std::vector<std::vector<std::vector<double>>>& replicated) const;

  private:
    /// Rows put together at places: by the residual's size, a covariate, a run.
    struct Grouping {
        std::vector<int> place;  ///< of each row; -1: none
        std::size_t count = 0;
    };
    void add_marginal(const std::vector<double>& measured, const std::string& residual);
    void add_autocorrelation();
    void add_covariate(const stats::Covariate& covariate, const std::string& residual);
    void add_spread();

    const Observable& observable_;
    std::vector<PredictiveCurve> places_;  ///< names, labels and places; values still missing
    std::vector<double> edges_;            ///< of the marginal law's bins
    std::size_t lags_ = 0;
    std::vector<Grouping> groupings_;  ///< of the covariates, then of runs
};

}  // namespace puckloop::gap
