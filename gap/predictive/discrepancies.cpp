#include "gap/predictive/discrepancies.h"

#include "gap/diagnostics/leftovers.h"
#include "gap/residuals/main_covariates.h"
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

Discrepancy marginal_law(const std::vector<double>& measured, const std::string& residual) {
    const double low = stats::quantile(measured, kOuter), high = stats::quantile(measured, 1 - kOuter);
    const double width = (high - low) / kInnerBins;
    Discrepancy law{{"marginal law", residual, "rows (%)", Residual::Horizontal}};
    std::vector<double> edges;
    for (std::size_t b = 0; b <= kInnerBins; ++b)
        edges.push_back(low + width * static_cast<double>(b));
    for (std::size_t b = 0; b < kInnerBins + 2; ++b)
        law.curve.x.push_back(low + width * (static_cast<double>(b) - 0.5));
    law.values_of = [edges](const std::vector<double>& residuals) {
        std::vector<double> shares(edges.size() + 1, 0.0);
        const std::vector<double> known = stats::finite(residuals);
        for (const double one : known)
            shares[static_cast<std::size_t>(std::ranges::upper_bound(edges, one) - edges.begin())] += 1;
        for (double& share : shares)
            share *= 100 / std::max(static_cast<double>(known.size()), 1.0);
        return shares;
    };
    return law;
}

Discrepancy autocorrelation(const Observable& observable) {
    std::size_t longest = 0, chain = 0;
    for (const char starts : observable.starts) {
        chain = starts != 0 ? 1 : chain + 1;
        longest = std::max(longest, chain);
    }
    const std::size_t lags = std::min(kMostLags, longest / 3);
    Discrepancy carried{{"autocorrelation", "rows apart", "correlation", Residual::Nowhere}};
    for (std::size_t lag = 1; lag <= lags; ++lag)
        carried.curve.x.push_back(static_cast<double>(lag));
    carried.values_of = [&observable, lags](const std::vector<double>& residuals) {
        std::vector<double> products(lags + 1, 0.0);
        std::size_t before = 0;  // rows of the chain before this one
        for (std::size_t i = 0; i < residuals.size(); ++i, ++before) {
            if (observable.starts[i] != 0) before = 0;
            for (std::size_t lag = 0; lag <= std::min(lags, before); ++lag)
                if (const double product = residuals[i] * residuals[i - lag]; std::isfinite(product))
                    products[lag] += product;
        }
        std::vector<double> correlations;
        for (std::size_t lag = 1; lag <= lags; ++lag)
            correlations.push_back(products[0] > 0 ? products[lag] / products[0] : NAN);
        return correlations;
    };
    return carried;
}

Discrepancy against(const stats::Covariate& covariate, const std::string& residual, bool counts) {
    Discrepancy course{{covariate.name, covariate_label(covariate.name), residual, Residual::Vertical}};
    PredictiveCurve& curve = course.curve;
    curve.counts = counts;
    int count = 0;
    const std::vector<int> place = stats::bins_of(covariate.value, count, kBins, kLevels);
    curve.x = stats::means_at(place, count, covariate.value);
    if (covariate.kind == stats::CovariateKind::Label)
        for (std::size_t k = 0; k < curve.x.size(); ++k) {
            const auto index = static_cast<std::size_t>(std::max(curve.x[k], 0.0));
            curve.categories.push_back(index < covariate.labels.size() ? covariate.labels[index]
                                                                       : fmt::format("{:g}", curve.x[k]));
            curve.x[k] = static_cast<double>(k);
        }
    course.values_of = [place, count](const std::vector<double>& residuals) {
        return stats::means_at(place, count, residuals);
    };
    return course;
}

/// Mean sizes. (Squares of heavy tails say little.)
Discrepancy spread_per_run(const Observable& observable) {
    Discrepancy spread{{"spread per run", "run", "mean size", Residual::Vertical}};
    spread.curve.counts = is_replicated(observable);
    const std::vector<int> run(observable.run.begin(), observable.run.end());
    const int count = run.empty() ? 0 : std::ranges::max(run) + 1;
    for (int k = 0; k < count; ++k)
        spread.curve.x.push_back(k + 1);
    spread.values_of = [run, count](std::vector<double> residuals) {
        for (double& one : residuals)
            one = std::abs(one);
        return stats::means_at(run, count, residuals);
    };
    return spread;
}

}  // namespace

bool is_replicated(const Observable& observable) {
    return observable.noise == NoiseKind::Carry && !is_counter(observable.name);
}

PredictiveCurve Discrepancy::judged() const {
    PredictiveCurve all = curve;
    std::vector<double> centre, deviation;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
        std::vector<double> here;
        for (const auto& one : replicated)
            here.push_back(one[k]);
        centre.push_back(stats::mean(here));
        deviation.push_back(stats::standard_deviation(here));
        all.low.push_back(stats::quantile(here, kLow));
        all.high.push_back(stats::quantile(here, kHigh));
    }
    const double most = farthest(curve.measured, centre, deviation);
    std::vector<double> far;
    for (const auto& one : replicated)
        far.push_back(farthest(one, centre, deviation));
    const auto as_far = std::ranges::count_if(far, [&](double one) { return one >= most; });
    all.p = static_cast<double>(as_far + 1) / static_cast<double>(replicated.size() + 1);
    all.tail = as_far == 0 ? std::min(all.p, stats::fitted_tail(far, most)) : all.p;
    return all;
}

std::vector<Discrepancy> discrepancies_of(const Observable& observable, const std::vector<double>& measured,
                                          const std::vector<stats::Covariate>& covariates,
                                          const std::string& residual) {
    std::vector<Discrepancy> all{marginal_law(measured, residual), autocorrelation(observable)};
    for (const stats::Covariate& one : covariates)
        all.push_back(against(one, residual, is_replicated(observable)));
    all.push_back(spread_per_run(observable));
    for (Discrepancy& one : all)
        one.curve.measured = one.values_of(measured);
    return all;
}

}  // namespace puckloop::gap
