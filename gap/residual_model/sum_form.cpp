#include "gap/residual_model/sum_form.h"

#include "gap/evidence/thresholds.h"
#include "gap/findings/quantities.h"
#include "gap/fit/likelihood.h"
#include "gap/fit/study.h"
#include "gap/fit/sum_response.h"
#include "gap/stats/parts.h"
#include "gap/stats/robust.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace puckloop::gap {

namespace {

using namespace thresholds;

constexpr double kTrim = 4.0;             // deviations
constexpr std::size_t kKept = 60;         // columns that a pursuit looks at, the best by themselves
constexpr std::size_t kMostTerms = 4;     // of a pursuit
constexpr double kMostDeviations = 10.0;  // that a term may move an innovation, root mean square
constexpr Effort kSumEffort{.iterations = 12};
constexpr std::size_t kManyResidualRows = 6000;
constexpr double kStill = 1e-9;                 // root mean square of increments: nothing moves
constexpr double kCalmer[] = {1.0, 0.1, 0.01};  // shares of the fitted drift; structure looks like drift

/// What a cell's rows add: the same each, or in proportion to what some sum gains in them.
struct Amount {
    std::string of, unit;  ///< empty: the same each
    std::vector<double> value;
};

struct Column {
    std::size_t amount = 0, component = 0;
    int cell = 0;
    bool above = false;  ///< this cell and all above it
};

/// What all cells from each on say together.
Eigen::ArrayXd from_each_on(Eigen::ArrayXd answer) {
    for (Eigen::Index c = answer.size() - 1; c-- > 0;)
        answer[c] += answer[c + 1];
    return answer;
}

/// The sum at one share of its fitted drift.
struct View {
    SumResponse response;
    std::vector<double> target;  ///< innovations, the wildest pulled in; 0 where there is none
    std::vector<char> used;

    View(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise)
        : response(observable, predicted, noise), target(response.innovations()) {
        const double limit = kTrim * std::max(stats::robust_scale(target), 1e-9);
        for (double& z : target) {
            used.push_back(std::isfinite(z) ? 1 : 0);
            z = used.back() != 0 ? std::clamp(z, -limit, limit) : 0.0;
        }
    }
};

/// Columns of all cells and amounts, and what each says of the innovations in the rows of each fold.
class Columns {
  public:
    Columns(const View& view, const std::vector<stats::Component>& cells, const std::vector<Amount>& amounts,
            const stats::Parts& parts)
        : response_(view.response), cells_(cells), amounts_(amounts), rows_(view.target.size()) {
        const auto folds = static_cast<Eigen::Index>(parts.folds);
        for (std::size_t a = 0; a < amounts.size(); ++a)
            for (std::size_t g = 0; g < cells.size(); ++g) {
                Eigen::ArrayXXd pull = Eigen::ArrayXXd::Zero(cells[g].cells, folds), square = pull,
                                above_square = pull;
                view.response.respond(cells[g].cell, cells[g].cells, amounts[a].value,
                                      [&](std::size_t i, const Eigen::ArrayXd& answer) {
                                          pull.col(parts.fold[i]) += answer * view.target[i];
                                          square.col(parts.fold[i]) += answer.square();
                                          if (cells[g].ordered)
                                              above_square.col(parts.fold[i]) +=
                                                  from_each_on(answer).square();
                                      });
                add(a, g, false, pull, square);
                if (!cells[g].ordered) continue;
                for (Eigen::Index c = pull.rows() - 1; c-- > 0;)
                    pull.row(c) += pull.row(c + 1);
                add(a, g, true, pull, above_square);
            }
    }

    /// ln of how many there are: of so many the best says as much by chance.
    double chance() const { return std::log(static_cast<double>(std::max<std::size_t>(columns_.size(), 2))); }
    /// How much of a column moves the innovations by one deviation, root mean square.
    double size_of(std::size_t k) const {
        return std::sqrt(static_cast<double>(rows_) / std::max(square_[k].sum(), 1e-12));
    }
    /// What a column adds up to.
    std::vector<double> sum(std::size_t k, const std::vector<char>& starts) const {
        const Column& column = columns_[k];
        const std::vector<int>& cell = cells_[column.component].cell;
        std::vector<double> all(cell.size(), 0.0);
        for (std::size_t i = 1; i < cell.size(); ++i) {
            if (starts[i] != 0) continue;
            const bool inside = column.above ? cell[i] >= column.cell : cell[i] == column.cell;
            all[i] = all[i - 1] + (inside ? amounts_[column.amount].value[i] : 0.0);
        }
        return all;
    }
    const Column& operator[](std::size_t k) const { return columns_[k]; }

    /// Those that say most by themselves in the rows that are not held out (held = -1: in all).
    std::vector<std::size_t> best(int held) const {
        std::vector<std::pair<double, std::size_t>> all;
        for (std::size_t k = 0; k < columns_.size(); ++k) {
            double pull = pull_[k].sum(), square = square_[k].sum();
            if (held >= 0) {
                pull -= pull_[k][held];
                square -= square_[k][held];
            }
            if (square > 1e-6 * square_[k].sum()) all.emplace_back(pull * pull / square, k);
        }
        std::ranges::stable_sort(all, [](const auto& x, const auto& y) { return x.first > y.first; });
        if (all.size() > kKept) all.resize(kKept);
        std::vector<std::size_t> kept;
        for (const auto& [score, k] : all)
            kept.push_back(k);
        std::ranges::sort(kept);  // cells of a component together
        return kept;
    }

    /// A column each of `kept`, a row each of the observable; 0 where a row says nothing.
    Eigen::MatrixXd dense(const std::vector<std::size_t>& kept) const {
        Eigen::MatrixXd matrix =
            Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(rows_), static_cast<Eigen::Index>(kept.size()));
        for (std::size_t from = 0; from < kept.size();) {
            const Column& first = columns_[kept[from]];
            std::size_t to = from;
            while (to < kept.size() && columns_[kept[to]].component == first.component &&
                   columns_[kept[to]].amount == first.amount)
                ++to;
            response_.respond(cells_[first.component].cell, cells_[first.component].cells,
                              amounts_[first.amount].value, [&](std::size_t i, const Eigen::ArrayXd& answer) {
                                  for (std::size_t k = from; k < to; ++k) {
                                      const Column& column = columns_[kept[k]];
                                      matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
                                          column.above ? answer.tail(answer.size() - column.cell).sum()
                                                       : answer[column.cell];
                                  }
                              });
            from = to;
        }
        return matrix;
    }

  private:
    void add(std::size_t amount, std::size_t component, bool above, const Eigen::ArrayXXd& pull,
             const Eigen::ArrayXXd& square) {
        for (Eigen::Index c = above ? 1 : 0; c < pull.rows(); ++c) {
            if (!(square.row(c).sum() > 0)) continue;
            columns_.push_back({amount, component, static_cast<int>(c), above});
            pull_.emplace_back(pull.row(c).transpose());
            square_.emplace_back(square.row(c).transpose());
        }
    }

    const SumResponse& response_;
    const std::vector<stats::Component>& cells_;
    const std::vector<Amount>& amounts_;
    std::size_t rows_;
    std::vector<Column> columns_;
    std::vector<Eigen::ArrayXd> pull_, square_;  // a fold each
};

/// Matching pursuit on the rows that are not held out: the columns it takes, the first one first.
std::vector<std::size_t> pursued(const Columns& columns, const View& view, const stats::Parts& parts,
                                 int held) {
    const auto kept = columns.best(held);
    Eigen::MatrixXd learnt = columns.dense(kept);
    Eigen::VectorXd rest = Eigen::VectorXd::Map(view.target.data(), learnt.rows());
    double count = 0.0;
    for (Eigen::Index i = 0; i < rest.size(); ++i) {
        const auto row = static_cast<std::size_t>(i);
        if (view.used[row] != 0 && parts.fold[row] != held) {
            count += 1;
            continue;
        }
        rest[i] = 0.0;
        learnt.row(i).setZero();
    }
    const Eigen::ArrayXd squares = learnt.colwise().squaredNorm().transpose().array().max(1e-12);
    std::vector<std::size_t> taken;
    while (taken.size() < kMostTerms && !kept.empty()) {
        const double variance = std::max(rest.squaredNorm() / std::max(count, 1.0), 1e-12);
        const Eigen::VectorXd pull = learnt.transpose() * rest;
        Eigen::Index best = 0;
        const double won = (pull.array().square() / squares).maxCoeff(&best) / variance;
        if (won < 2 * columns.chance()) break;
        rest -= pull[best] / squares[best] * learnt.col(best);
        taken.push_back(kept[static_cast<std::size_t>(best)]);
    }
    return taken;
}

std::vector<Amount> amounts_of(const Model& model, const Prediction& prediction, std::size_t o) {
    const Observable& own = model.observables()[o];
    std::vector<Amount> amounts{{"", "", std::vector<double>(own.y.size(), 1.0)}};
    for (std::size_t k = 0; k < prediction.size(); ++k) {
        const Observable& other = model.observables()[k];
        if (other.noise != NoiseKind::Level || other.fixed_sd > 0 || other.row != own.row) continue;
        Amount one{other.name, other.unit, std::vector<double>(own.y.size(), 0.0)};
        for (std::size_t i = 1; i < one.value.size(); ++i)
            if (own.starts[i] == 0) one.value[i] = prediction[k].mean[i] - prediction[k].mean[i - 1];
        const Eigen::Map<const Eigen::ArrayXd> value(one.value.data(),
                                                     static_cast<Eigen::Index>(one.value.size()));
        if (value.size() > 0 && std::sqrt(value.square().mean()) > kStill) amounts.push_back(std::move(one));
    }
    return amounts;
}

/// Runs of the same conditions repeat each other.
std::vector<int> likeness_of(const Experiment& experiment) {
    std::map<decltype(Run::conditions), int> kinds;
    std::vector<int> all;
    for (const Run& run : experiment.runs)
        all.push_back(kinds.try_emplace(run.conditions, static_cast<int>(kinds.size())).first->second);
    return all;
}

/// One observable with what some columns add to it, each times a number that can be fitted.
class WithColumns final : public Model {
  public:
    WithColumns(const Observable& observable, Predicted predicted, const Columns& columns,
                const std::vector<std::size_t>& terms)
        : predicted_(std::move(predicted)) {
        observables_.push_back(observable);
        for (const std::size_t term : terms) {
            (void)add(fmt::format("term{}", sums_.size()), "1", 0.0);
            sums_.push_back(columns.sum(term, observable.starts));
        }
        predicted_.lapse.clear();
        predicted_.lapse_scale.clear();
    }
    void predict(const std::vector<double>& values, Prediction& out) const override {
        out.assign(1, predicted_);
        for (std::size_t k = 0; k < sums_.size(); ++k)
            if (values[k] != 0.0)
                for (std::size_t i = 0; i < sums_[k].size(); ++i)
                    out[0].mean[i] += values[k] * sums_[k][i];
    }

  private:
    Predicted predicted_;
    std::vector<std::vector<double>> sums_;
};

/// Terms fitted, together with the noise, to the rows that are not held out.
struct Correction {
    const Columns* columns = nullptr;
    std::vector<std::size_t> terms;
    Fitted fitted;
    double merit = 0.0;        ///< ln likelihood of those rows, less what chance makes of so many columns
    std::vector<double> cost;  ///< of every row
};

FreeFormTerm term_of(const Column& column, double move, const std::vector<stats::Component>& cells,
                     const std::vector<Amount>& amounts, const std::string& unit) {
    const stats::Component& component = cells[column.component];
    const Amount& amount = amounts[column.amount];
    FreeFormTerm term;
    term.over = component.name + component.qualifier;
    term.where = {component.where[static_cast<std::size_t>(column.cell)]};
    term.values = {move};
    const std::string where =
        (column.above ? "from " : "at ") + term.where.front() + (column.above ? " on" : "");
    term.shape = amount.of.empty() ? fmt::format("{} a row {}", change(move, unit), where)
                 : amount.unit == unit
                     ? fmt::format("{:+.3g} % of {} {}", 100 * move, plain_observable(amount.of), where)
                     : fmt::format("{:+.3g} {}/{} of {} {}", move, unit, amount.unit,
                                   plain_observable(amount.of), where);
    return term;
}

}  // namespace

FreeForm sum_form_of(const Experiment& experiment, const Model& model, const State& state,
                     const Prediction& prediction, std::size_t o, std::vector<stats::Component> cells,
                     std::uint64_t seed) {
    const Observable& observable = model.observables()[o];
    // Where rows are many, covariates by themselves only: their pairs would take minutes.
    if (observable.y.size() > kManyResidualRows)
        std::erase_if(cells, [](const stats::Component& one) { return one.pair; });
    FreeForm form;
    form.observable = observable.name;
    form.unit = observable.unit;
    form.gain = -INFINITY;
    const auto parts = stats::parts_of(std::vector<int>(observable.run.begin(), observable.run.end()), seed,
                                       likeness_of(experiment));
    if (cells.empty() || parts.folds < 2) return form;
    const auto amounts = amounts_of(model, prediction, o);
    std::vector<View> views;
    std::vector<Columns> columns;
    views.reserve(std::size(kCalmer));
    for (const double calmer : kCalmer) {
        NoiseParameters noise = state.noise[o];
        noise.carry += std::log(calmer);
        views.emplace_back(observable, prediction[o], noise);
        columns.emplace_back(views.back(), cells, amounts, parts);
    }
    // Without terms first; then with those that stand out at each share of the drift.
    const auto best_without = [&](int held, Correction& plain) {
        Weights weights(1);
        for (const int fold : parts.fold)
            weights[0].push_back(fold == held ? 0.0 : 1.0);
        const auto corrected = [&](const Columns& from, std::vector<std::size_t> terms) {
            const WithColumns with(observable, prediction[o], from, terms);
            std::vector<Freed> freed;
            for (std::size_t k = 0; k < terms.size(); ++k) {
                const double size = from.size_of(terms[k]);
                freed.push_back({k, -kMostDeviations * size, kMostDeviations * size, size});
            }
            State start{with.neutral(), {state.noise[o]}};
            Correction made{&from, std::move(terms), fit(with, freed, start, weights, kSumEffort), 0.0, {}};
            const State& end = made.fitted.state;
            made.cost = costs_at(with, end, with.predicted(end.values)).front().cost;
            made.merit = made.fitted.log_likelihood - from.chance() * static_cast<double>(made.terms.size());
            return made;
        };
        plain = corrected(columns.front(), {});
        Correction best = plain;
        std::vector<std::vector<std::size_t>> seen;
        for (std::size_t v = 0; v < views.size(); ++v) {
            auto terms = pursued(columns[v], views[v], parts, held);
            if (terms.empty() || stats::contains(seen, terms)) continue;
            seen.push_back(terms);
            Correction one = corrected(columns[v], std::move(terms));
            if (one.merit > best.merit) best = std::move(one);
        }
        return best;
    };
    std::vector<double> gains(parts.blocks, 0.0);
    Correction plain;
    for (std::size_t fold = 0; fold < parts.folds; ++fold) {
        const Correction best = best_without(static_cast<int>(fold), plain);
        for (std::size_t i = 0; i < parts.fold.size(); ++i)
            if (parts.fold[i] == static_cast<int>(fold))
                gains[static_cast<std::size_t>(parts.block[i])] += plain.cost[i] - best.cost[i];
    }
    const Gain gain = gain_of(gains);
    form.gain = gain.sum;
    form.sd = gain.sd;
    const Correction all = best_without(-1, plain);
    for (std::size_t k = 0; k < all.terms.size(); ++k)
        form.terms.push_back(term_of((*all.columns)[all.terms[k]], all.fitted.state.values[k], cells, amounts,
                                     observable.unit));
    // What is held out was not fitted: chance alone wins nothing there. That one odd run could.
    const bool several = gain.without_best > kClearForm && gain.clearly_better > 2 * gain.clearly_worse;
    form.clear = form.gain > kClearForm &&
                 (form.gain > kFormErrors * form.sd || gain.in_several() || several) && !form.terms.empty();
    if (form.clear) form.shape = form.terms.front().shape;
    return form;
}

}  // namespace puckloop::gap
