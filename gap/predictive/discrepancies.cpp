#include "gap/predictive/discrepancies.h"

#include "gap/diagnostics/leftovers.h"
#include "gap/predictive/main_covariates.h"
#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

using Residual = PredictiveCurve::Residual;

constexpr std::size_t kInnerBins = 18;  // of the marginal law; one more at each end is open
constexpr double kOuter = 0.005;        // of the residuals lie beyond the inner bins, on each side
constexpr std::size_t kMostLags = 12;
constexpr int kBins = 12, kLevels = 16;  // of a covariate; up to so many different values stand by themselves
constexpr double kLow = 0.05, kHigh = 0.95;  // of the envelope
constexpr double kLeastVaries = 1e-12;       // of a place's size: replicates that do not differ there

/// Means of groups, of sizes or of the values themselves. (Squares of heavy tails say little.)
std::vector<double> of_groups(const std::vector<double>& residuals, const std::vector<int>& place,
                              std::size_t count, bool sizes) {
    std::vector<double> sum(count, 0.0), rows(count, 0.0);
    for (std::size_t i = 0; i < residuals.size(); ++i) {
        if (place[i] < 0 || std::isnan(residuals[i])) continue;
        const auto at = static_cast<std::size_t>(place[i]);
        sum[at] += sizes ? std::abs(residuals[i]) : residuals[i];
        rows[at] += 1;
    }
    for (std::size_t k = 0; k < count; ++k)
        sum[k] = rows[k] > 0 ? sum[k] / rows[k] : NAN;
    return sum;
}

/// The largest distance from `centre`, in deviations of the replicates.
double farthest(const std::vector<double>& curve, const std::vector<double>& centre,
                const std::vector<double>& deviation) {
    double most = 0.0;
    for (std::size_t k = 0; k < curve.size(); ++k) {
        const double off = std::abs(curve[k] - centre[k]);
        const double least = kLeastVaries * std::max(std::abs(centre[k]), 1.0);
        if (off > least) most = std::max(most, off / std::max(deviation[k], least));
    }
    return most;
}

}  // namespace

bool is_replicated(const Observable& observable) {
    return observable.noise == NoiseKind::Carry && !is_counter(observable.name);
}

Discrepancies::Discrepancies(const Observable& observable, const std::vector<double>& measured,
                             const std::vector<stats::Covariate>& covariates, const std::string& residual)
    : observable_(observable) {
    add_marginal(measured, residual);
    add_autocorrelation();
    for (const stats::Covariate& one : covariates)
        add_covariate(one, residual);
    add_spread();
}

void Discrepancies::add_marginal(const std::vector<double>& measured, const std::string& residual) {
    const double low = stats::quantile(measured, kOuter), high = stats::quantile(measured, 1 - kOuter);
    const double width = (high - low) / kInnerBins;
    PredictiveCurve curve{"marginal law", residual, "rows (%)", Residual::Horizontal};
    for (std::size_t b = 0; b <= kInnerBins; ++b)
        edges_.push_back(low + width * static_cast<double>(b));
    for (std::size_t b = 0; b < kInnerBins + 2; ++b)
        curve.x.push_back(low + width * (static_cast<double>(b) - 0.5));
    places_.push_back(std::move(curve));
}

void Discrepancies::add_autocorrelation() {
    std::size_t longest = 0, chain = 0;
    for (std::size_t i = 0; i < observable_.y.size(); ++i) {
        chain = observable_.starts[i] != 0 ? 1 : chain + 1;
        longest = std::max(longest, chain);
    }
    lags_ = std::min(kMostLags, longest / 3);
    PredictiveCurve curve{"autocorrelation", "rows apart", "correlation", Residual::Nowhere};
    for (std::size_t lag = 1; lag <= lags_; ++lag)
        curve.x.push_back(static_cast<double>(lag));
    places_.push_back(std::move(curve));
}

void Discrepancies::add_covariate(const stats::Covariate& covariate, const std::string& residual) {
    std::vector<double> known;
    for (const double value : covariate.value)
        if (std::isfinite(value)) known.push_back(value);
    int count = 0;
    const std::vector<int> bin = stats::bins_of(known, count, kBins, kLevels);
    Grouping grouping{std::vector<int>(covariate.value.size(), -1), static_cast<std::size_t>(count)};
    for (std::size_t i = 0, k = 0; i < covariate.value.size(); ++i)
        if (std::isfinite(covariate.value[i])) grouping.place[i] = bin[k++];
    PredictiveCurve curve{covariate.name, covariate_label(covariate.name), residual, Residual::Vertical};
    curve.counts = is_replicated(observable_);
    curve.x = of_groups(covariate.value, grouping.place, grouping.count, false);
    if (covariate.kind == stats::CovariateKind::Label)
        for (std::size_t k = 0; k < grouping.count; ++k) {
            const auto index = static_cast<std::size_t>(std::max(curve.x[k], 0.0));
            curve.categories.push_back(index < covariate.labels.size() ? covariate.labels[index]
                                                                       : fmt::format("{:g}", curve.x[k]));
            curve.x[k] = static_cast<double>(k);
        }
    places_.push_back(std::move(curve));
    groupings_.push_back(std::move(grouping));
}

void Discrepancies::add_spread() {
    Grouping grouping{{observable_.run.begin(), observable_.run.end()}, 0};
    for (const std::uint32_t run : observable_.run)
        grouping.count = std::max<std::size_t>(grouping.count, run + 1);
    PredictiveCurve curve{"spread per run", "run", "mean size", Residual::Vertical};
    curve.counts = is_replicated(observable_);
    for (std::size_t run = 0; run < grouping.count; ++run)
        curve.x.push_back(static_cast<double>(run + 1));
    places_.push_back(std::move(curve));
    groupings_.push_back(std::move(grouping));
}

std::vector<std::vector<double>> Discrepancies::values_of(const std::vector<double>& residuals) const {
    std::vector<std::vector<double>> all;
    std::vector<double> shares(edges_.size() + 1, 0.0);
    double known = 0.0;
    for (const double one : residuals)
        if (std::isfinite(one)) {
            shares[static_cast<std::size_t>(std::upper_bound(edges_.begin(), edges_.end(), one) -
                                            edges_.begin())] += 1;
            known += 1;
        }
    for (double& share : shares)
        share *= 100 / std::max(known, 1.0);
    all.push_back(std::move(shares));
    std::vector<double> products(lags_ + 1, 0.0);
    std::size_t chain = 0;  // rows of it before this one
    for (std::size_t i = 0; i < residuals.size(); ++i, ++chain) {
        if (observable_.starts[i] != 0) chain = 0;
        for (std::size_t lag = 0; lag <= std::min(lags_, chain); ++lag)
            if (const double product = residuals[i] * residuals[i - lag]; std::isfinite(product))
                products[lag] += product;
    }
    std::vector<double> correlations;
    for (std::size_t lag = 1; lag <= lags_; ++lag)
        correlations.push_back(products[0] > 0 ? products[lag] / products[0] : NAN);
    all.push_back(std::move(correlations));
    for (const Grouping& grouping : groupings_)
        all.push_back(of_groups(residuals, grouping.place, grouping.count, &grouping == &groupings_.back()));
    return all;
}

std::vector<PredictiveCurve>
Discrepancies::curves(const std::vector<double>& measured,
                      const std::vector<std::vector<std::vector<double>>>& replicated) const {
    std::vector<PredictiveCurve> all = places_;
    const auto of_measured = values_of(measured);
    for (std::size_t c = 0; c < all.size(); ++c) {
        PredictiveCurve& curve = all[c];
        curve.measured = of_measured[c];
        std::vector<double> centre, deviation;
        for (std::size_t k = 0; k < curve.x.size(); ++k) {
            std::vector<double> here;
            for (const auto& one : replicated)
                here.push_back(one[c][k]);
            centre.push_back(stats::mean(here));
            deviation.push_back(stats::standard_deviation(here));
            curve.low.push_back(stats::quantile(here, kLow));
            curve.high.push_back(stats::quantile(here, kHigh));
        }
        const double most = farthest(curve.measured, centre, deviation);
        std::vector<double> far;
        for (const auto& one : replicated)
            far.push_back(farthest(one[c], centre, deviation));
        const auto as_far = std::count_if(far.begin(), far.end(), [&](double one) { return one >= most; });
        curve.p = static_cast<double>(as_far + 1) / static_cast<double>(replicated.size() + 1);
        curve.tail = as_far == 0 ? std::min(curve.p, stats::fitted_tail(far, most)) : curve.p;
    }
    return all;
}

}  // namespace puckloop::gap
