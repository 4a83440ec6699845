#include "gap/decide/no_mechanism.h"

#include "gap/fit/filter.h"
#include "gap/fit/likelihood.h"
#include "gap/stats/series.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

namespace puckloop::gap {

namespace {

using stats::normal_density;

constexpr int kSteps = 60;                // of expectation maximisation; it settles within some ten
constexpr double kFewest = 1e-3;          // share of larger errors
constexpr double kMost = 0.3;             // beyond, they are not the few
constexpr double kLeastFactor = 1.5;      // by which they are larger
constexpr double kBegun[] = {0.02, 4.0};  // share and factor, at first

struct Law {
    double share = kBegun[0], sd = 1.0, factor = kBegun[1];

    double density(double z) const {
        return (1 - share) * normal_density(z, sd) + share * normal_density(z, sd * factor);
    }
};

struct ExplainedRow {
    double z;               ///< standardised innovation
    double lapse, outside;  ///< chance that the fit's causes make it an error of theirs, and its density then
    double log_before;      ///< log density of both together, errors by Student's t
    std::uint32_t block;

    double density(double inside) const { return (1 - lapse) * inside + lapse * outside; }
};

Law fitted_without(const std::vector<ExplainedRow>& rows, std::uint32_t block) {
    Law law;
    for (int step = 0; step < kSteps; ++step) {
        double large = 0.0, large_squares = 0.0, squares = 0.0, usual = 0.0;
        for (const ExplainedRow& row : rows) {
            if (row.block == block) continue;
            const double inside = law.density(row.z), all = row.density(inside);
            const double mine = all > 0 ? (1 - row.lapse) * inside / all : 1.0;
            const double wide = law.share * normal_density(row.z, law.sd * law.factor);
            const double chance = inside > 0 ? wide / inside : 1.0;
            large += mine * chance;
            large_squares += mine * chance * row.z * row.z;
            squares += mine * (1 - chance) * row.z * row.z;
            usual += mine * (1 - chance);
        }
        if (!(usual > 0) || !(large > 0)) break;
        law.share = std::clamp(large / (large + usual), kFewest, kMost);
        law.sd = std::sqrt(squares / usual);
        law.factor = std::max(std::sqrt(large_squares / large) / law.sd, kLeastFactor);
    }
    return law;
}

/// Rows of errors that may follow the law; none where what a cause does is carried on from row to row.
std::vector<ExplainedRow> rows_of(const Predicted& predicted, const NoiseParameters& noise,
                                  const Innovations& innovations, const std::vector<std::uint32_t>& blocks) {
    std::vector<ExplainedRow> rows;
    if (!innovations.mixed.empty()) return rows;
    const stats::StudentLaw usual(std::exp(noise.log_tail));
    for (std::size_t i = 0; i < innovations.z.size(); ++i) {
        if (innovations.role[i] != RowRole::Plain) continue;
        const double z = innovations.z[i];
        ExplainedRow row{z, 0.0, 0.0, 0.0, blocks[i]};
        if (!predicted.lapse.empty() && predicted.lapse[i] > 0.0) {
            const double scale = std::sqrt(innovations.variance[i]),
                         shift = of_row(predicted.lapse_shift, i) / scale,
                         width = std::hypot(predicted.lapse_scale[i] / scale, 1.0),
                         up = normal_density(z - shift, width);
            row.lapse = predicted.lapse[i];
            row.outside = predicted.lapse_both ? (up + normal_density(z + shift, width)) / 2 : up;
        }
        row.log_before = std::log(row.density(usual.density(z)));
        rows.push_back(row);
    }
    return rows;
}

/// How many of some rows happened; half of one each way is known beforehand (Jeffreys).
struct Count {
    double yes = 0.5, no = 0.5;
    void add(double y) { (y > 0.5 ? yes : no) += 1; }
    double score(double y) const { return std::log((y > 0.5 ? yes : no) / (yes + no)); }
};

}  // namespace

std::vector<double> scores_with_large_errors(const Study& study, const Fit& fit,
                                             const std::vector<std::string>& touched) {
    std::vector<double> scores(study.blocks().count, 0.0);
    const State& state = fit.fitted.state;
    const Prediction prediction = study.model().predicted(state.values);
    for (std::size_t o = 0; o < prediction.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        if (!stats::contains(touched, observable.name)) continue;
        const auto& blocks = study.blocks().of[o];
        Innovations innovations;
        filter(observable, prediction[o], state.noise[o], innovations);
        std::vector<double> cost;
        costs_of(observable, prediction[o], state.noise[o], innovations, cost);
        for (std::size_t i = 0; i < cost.size(); ++i)
            scores[blocks[i]] -= cost[i];
        const auto rows = rows_of(prediction[o], state.noise[o], innovations, blocks);
        std::vector<double> won(scores.size(), 0.0);
        for (std::uint32_t block = 0; block < won.size(); ++block) {
            const Law law = fitted_without(rows, block);
            for (const ExplainedRow& row : rows)
                if (row.block == block)
                    won[block] += std::log(row.density(law.density(row.z))) - row.log_before;
        }
        if (std::accumulate(won.begin(), won.end(), 0.0) > 0)
            std::transform(scores.begin(), scores.end(), won.begin(), scores.begin(), std::plus<>());
    }
    return scores;
}

double gained_by_rate(const Study& study, const Selection& selection, std::size_t o) {
    const Observable& observable = study.model().observables()[o];
    if (observable.noise != NoiseKind::Event) return 0.0;
    const auto& fold = study.fold_of()[o];
    std::vector<Count> others(study.folds());
    for (std::size_t i = 0; i < fold.size(); ++i)
        for (std::size_t k = 0; k < others.size(); ++k)
            if (fold[i] != static_cast<int>(k)) others[k].add(observable.y[i]);
    double gained = 0.0;
    for (std::size_t i = 0; i < fold.size(); ++i)
        gained += others[static_cast<std::size_t>(fold[i])].score(observable.y[i]) -
                  selection.held_none.score[o][i];
    return std::max(gained, 0.0);
}

double lowered_by_rate(const Observable& observable, double cost) {
    if (observable.noise != NoiseKind::Event) return 0.0;
    Count all;
    for (const double y : observable.y)
        all.add(y);
    const auto added = [&](double sum, double y) { return sum - all.score(y); };
    return std::max(cost - std::accumulate(observable.y.begin(), observable.y.end(), 0.0, added), 0.0);
}

}  // namespace puckloop::gap
