#pragma once
// What a posterior-predictive check found (Gelman, Meng and Stern, Statistica Sinica 6, 1996): curves made of
// the residuals, of what was measured and of data replicated from the fitted model.

#include <string>
#include <vector>

namespace puckloop::gap {

/// One discrepancy of one observable. NaN where it has no value.
struct PredictiveCurve {
    std::string name;              ///< "marginal law", "autocorrelation", "distance", ..., "spread per run"
    std::string x_label, y_label;  ///< with units, but for the residual's
    enum class Residual { Nowhere, Horizontal, Vertical } residual;  ///< the axis in the check's unit
    std::vector<double> x{};                                         ///< places; of categories 0, 1, ...
    std::vector<double> measured{};                                  ///< of what was measured
    std::vector<double> low{}, high{};      ///< 5 % and 95 % of the replicated data, place by place
    std::vector<std::string> categories{};  ///< names of the places; empty: numbers
    /// Share of data sets, the measured one among them, whose largest distance from the replicates' mean (in
    /// their own deviations, place by place) is at least that of the measured one.
    double p = 1.0;
    double tail =
        1.0;  ///< the same, where none is as far carried on by a gamma distribution (stats/exchange.h)
    bool counts = false;  ///< in the decision
};

/// One observable, by the simulator as it is (its errors fitted) or with the chosen causes.
struct PredictiveCheck {
    std::string observable, unit;
    bool extended = false;  ///< with the chosen causes
    int replicates = 0;
    std::vector<PredictiveCurve> curves;
};

}  // namespace puckloop::gap
