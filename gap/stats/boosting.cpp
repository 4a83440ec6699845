#include "gap/stats/boosting.h"

#include "gap/stats/parts.h"
#include "gap/stats/robust.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace puckloop::gap::stats {

namespace {

constexpr int kMostSteps = 60;
constexpr double kPace = 0.6;        // of each step
constexpr double kFreedom = 1.5;     // degrees of freedom of each step, whatever the number of cells
constexpr double kTrim = 4.0;        // deviations
constexpr double kLeastWon = 1.0;    // of the errors' squares in units of their variance: less is not pursued
constexpr double kLooseEnds = 0.05;  // ridge of ordered cells beside their differences
constexpr std::size_t kKept = 40;    // components that stay in view between two looks at all
constexpr double kLessCarry = 0.35;
constexpr int kLookAgain = 10;  // steps

/// Errors and cells freed of what is carried over: a row has its own cell and the one of the row before.
class Design {
  public:
    Design(const ErrorRows& rows, const std::vector<Component>& components, double carry)
        : components_(components), carry_(carry), first_(std::sqrt(1 - carry * carry)) {
        const std::size_t n = rows.error.size();
        target_.assign(n, 0.0);
        used_.assign(n, 0);
        chained_.assign(n, 0);
        for (std::size_t i = 0; i < n; ++i) {
            if (!std::isfinite(rows.error[i])) continue;
            used_[i] = 1;
            chained_[i] = rows.follows[i] != 0 && std::isfinite(rows.error[i - 1]) ? 1 : 0;
            target_[i] = follows(i) ? rows.error[i] - carry * rows.error[i - 1] : first_ * rows.error[i];
        }
        if (!rows.trimmed) return;
        std::vector<double> values;
        for (std::size_t i = 0; i < n; ++i)
            if (used_[i] != 0) values.push_back(target_[i]);
        const double limit = kTrim * robust_scale(values);
        if (!(limit > 0)) return;
        for (double& value : target_)
            value = std::clamp(value, -limit, limit);
    }

    bool follows(std::size_t i) const { return chained_[i] != 0; }
    bool used(std::size_t i) const { return used_[i] != 0; }
    std::size_t rows() const { return target_.size(); }
    const std::vector<double>& target() const { return target_; }

    /// The row's share of cell values: own cell (p, a) and that of the row before (q, b); cell -1: none.
    struct Parts {
        int p, q;
        double a, b;
    };
    Parts parts(std::size_t g, std::size_t i) const {
        const Component& c = components_[g];
        const bool chained = follows(i);
        const int q = chained && carry_ != 0.0 ? c.cell[i - 1] : -1;
        return {c.cell[i], q, (chained ? 1.0 : first_) * weight_of(c, i),
                q < 0 ? 0.0 : -carry_ * weight_of(c, i - 1)};
    }

    /// How the rows that `learns` pull at a correction in each row, in the row itself and in the next, to
    /// which it is carried over: the same for every component, to be summed over cells.
    template <class Learns>
    void gather(const std::vector<double>& rest, const Learns& learns, std::vector<double>& pulled) const {
        pulled.assign(rest.size(), 0.0);
        for (std::size_t i = 0; i < rest.size(); ++i) {
            if (!learns(i)) continue;
            pulled[i] += (follows(i) ? 1.0 : first_) * rest[i];
            if (follows(i)) pulled[i - 1] -= carry_ * rest[i];
        }
    }

  private:
    const std::vector<Component>& components_;
    double carry_, first_;
    std::vector<double> target_;
    std::vector<char> used_, chained_;
};

/// What each component's cells know of each other: in all rows, and in those of each fold.
struct Grams {
    std::vector<Eigen::MatrixXd> all;
    std::vector<std::vector<Eigen::MatrixXd>> fold;

    /// In the rows of the folds but one (held = -1: of all).
    Eigen::MatrixXd without(std::size_t component, int held) const {
        if (held < 0) return all[component];
        return all[component] - fold[component][static_cast<std::size_t>(held)];
    }
};

Grams grams_of(const Design& design, const std::vector<Component>& components, const std::vector<int>& fold,
               std::size_t folds) {
    Grams grams;
    for (std::size_t g = 0; g < components.size(); ++g) {
        const auto cells = static_cast<Eigen::Index>(components[g].cells);
        std::vector<Eigen::MatrixXd> parts(folds, Eigen::MatrixXd::Zero(cells, cells));
        for (std::size_t i = 0; i < design.rows(); ++i) {
            if (!design.used(i)) continue;
            Eigen::MatrixXd& gram = parts[static_cast<std::size_t>(fold[i])];
            const auto [p, q, a, b] = design.parts(g, i);
            if (p >= 0) gram(p, p) += a * a;
            if (q >= 0) gram(q, q) += b * b;
            if (p >= 0 && q >= 0) {
                gram(p, q) += a * b;
                gram(q, p) += a * b;
            }
        }
        grams.all.push_back(Eigen::MatrixXd::Zero(cells, cells));
        for (const Eigen::MatrixXd& part : parts)
            grams.all.back() += part;
        grams.fold.push_back(std::move(parts));
    }
    return grams;
}

/// Pulls the cells of a component towards nothing, ordered ones towards their neighbours.
Eigen::MatrixXd penalty_of(const Component& component) {
    const int n = component.cells;
    Eigen::MatrixXd penalty = Eigen::MatrixXd::Identity(n, n);
    if (!component.ordered) return penalty;
    penalty *= kLooseEnds;
    for (int k = 0; k + 1 < n; ++k) {
        penalty(k, k) += 1;
        penalty(k + 1, k + 1) += 1;
        penalty(k, k + 1) -= 1;
        penalty(k + 1, k) -= 1;
    }
    return penalty;
}

/// Strength of the penalty that leaves a component its freedom; 0: its cells are empty.
double strength_for(const Eigen::MatrixXd& gram, const Eigen::MatrixXd& penalty) {
    const double size = gram.trace();
    if (!(size > 1e-9)) return 0.0;
    double low = std::log(size) - 25, high = std::log(size) + 10;
    const double wanted = std::min(kFreedom, 0.75 * static_cast<double>(gram.rows()));
    // Of eigenvalues e in the penalty's metric, each leaves e / (e + strength) of a degree of freedom.
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(
        gram, penalty, Eigen::EigenvaluesOnly | Eigen::Ax_lBx);
    const Eigen::ArrayXd values = solver.eigenvalues().array().max(0.0);
    for (int k = 0; k < 25; ++k) {
        const double middle = (low + high) / 2;
        const double freedom = (values / (values + std::exp(middle))).sum();
        (freedom > wanted ? low : high) = middle;
    }
    return std::exp(high);
}

/// Steps on the rows that are not held out.
class Booster {
  public:
    Booster(const Design& design, const std::vector<Component>& components, const std::vector<int>& fold,
            int held, const Grams& grams, const std::vector<double>& strength)
        : design_(design),
          components_(components),
          fold_(fold),
          held_(held),
          rest_(design.target()),
          inverse_(components.size()),
          values_(components.size()) {
        for (std::size_t i = 0; i < rest_.size(); ++i)
            if (learns(i)) ++count_;
        for (std::size_t g = 0; g < components.size(); ++g) {
            gram_.push_back(grams.without(g, held));
            if (strength[g] > 0)
                inverse_[g] = (gram_[g] + strength[g] * penalty_of(components[g]))
                                  .ldlt()
                                  .solve(Eigen::MatrixXd::Identity(gram_[g].rows(), gram_[g].rows()));
        }
    }

    /// One step; false when nothing is worth it.
    bool step() {
        if (taken_ % kLookAgain == 0) {
            view_.resize(components_.size());
            std::iota(view_.begin(), view_.end(), std::size_t{0});
        }
        std::vector<std::pair<double, std::size_t>> won;
        std::vector<Eigen::VectorXd> moves(components_.size());
        design_.gather(
            rest_, [this](std::size_t i) { return learns(i); }, pulled_);
        sum_pulls();
        for (const std::size_t g : view_) {
            if (inverse_[g].size() == 0) continue;
            const Eigen::Map<const Eigen::VectorXd> pull(pulls_[g].data() + 1, components_[g].cells);
            moves[g] = inverse_[g] * pull;
            won.emplace_back(2 * moves[g].dot(pull) - moves[g].dot(gram_[g] * moves[g]), g);
        }
        if (won.empty()) return false;
        std::ranges::stable_sort(won, [](const auto& x, const auto& y) { return x.first > y.first; });
        if (won.front().first < kLeastWon * variance()) return false;
        if (taken_ % kLookAgain == 0 && won.size() > kKept) won.resize(kKept);
        view_.clear();
        for (const auto& [gain, g] : won)
            view_.push_back(g);
        const std::size_t g = won.front().second;
        const Eigen::VectorXd move = kPace * moves[g];
        for (std::size_t i = 0; i < rest_.size(); ++i) {
            if (!design_.used(i)) continue;
            const auto [p, q, a, b] = design_.parts(g, i);
            rest_[i] -= (p >= 0 ? a * move[p] : 0.0) + (q >= 0 ? b * move[q] : 0.0);
        }
        if (values_[g].size() == 0) values_[g] = Eigen::VectorXd::Zero(move.size());
        values_[g] += move;
        ++taken_;
        return true;
    }

    /// Mean square of what is left of the rows that were learnt from.
    double variance() const {
        double sum = 0.0;
        for (std::size_t i = 0; i < rest_.size(); ++i)
            if (learns(i)) sum += rest_[i] * rest_[i];
        return std::max(sum / std::max(count_, 1.0), 1e-12);
    }
    double rest(std::size_t i) const { return rest_[i]; }
    const std::vector<Eigen::VectorXd>& values() const { return values_; }

  private:
    bool learns(std::size_t i) const { return design_.used(i) && fold_[i] != held_; }

    /// How the rows pull at each cell of what is in view. Rows in turn mostly lie in one cell, whose sum each
    /// has to wait for: several components at a time wait together.
    void sum_pulls() {
        pulls_.resize(components_.size());
        std::vector<std::size_t> even, weighted;
        for (const std::size_t g : view_)
            if (inverse_[g].size() != 0) (components_[g].weight.empty() ? even : weighted).push_back(g);
        constexpr std::size_t kTogether = 4;
        for (const bool weigh : {false, true}) {
            const auto& all = weigh ? weighted : even;
            std::size_t k = 0;
            for (; k + kTogether <= all.size(); k += kTogether)
                weigh ? sum_together<true, kTogether>(&all[k]) : sum_together<false, kTogether>(&all[k]);
            for (; k < all.size(); ++k)
                weigh ? sum_together<true, 1>(&all[k]) : sum_together<false, 1>(&all[k]);
        }
    }

    template <bool weigh, std::size_t count>
    void sum_together(const std::size_t* which) {
        std::array<double*, count> at;
        std::array<const int*, count> cell;
        std::array<const double*, count> weight;
        for (std::size_t k = 0; k < count; ++k) {
            const Component& c = components_[which[k]];
            pulls_[which[k]].assign(static_cast<std::size_t>(c.cells) + 1, 0.0);
            at[k] = pulls_[which[k]].data() + 1;  // the first is of rows without a cell
            cell[k] = c.cell.data();
            weight[k] = c.weight.data();
        }
        const auto add = [&]<std::size_t... k>(std::index_sequence<k...>) {
            for (std::size_t i = 0; i < pulled_.size(); ++i) {
                const double pull = pulled_[i];
                ((at[k][cell[k][i]] += weigh ? weight[k][i] * pull : pull), ...);
            }
        };
        add(std::make_index_sequence<count>());
    }

    const Design& design_;
    const std::vector<Component>& components_;
    const std::vector<int>& fold_;
    int held_;
    std::vector<double> rest_;
    double count_ = 0.0;
    int taken_ = 0;
    std::vector<Eigen::MatrixXd> gram_, inverse_;
    std::vector<Eigen::VectorXd> values_;
    std::vector<std::size_t> view_;
    std::vector<double> pulled_;
    std::vector<std::vector<double>> pulls_;  // a component each
};

}  // namespace

Boosted boosted(const ErrorRows& rows, const std::vector<Component>& components, std::uint64_t seed) {
    Boosted result;
    const std::size_t n = rows.error.size();
    result.carry = rows.carry;
    result.correction.assign(n, 0.0);
    result.weight.assign(components.size(), 0.0);
    const auto [fold, block, folds, blocks] = parts_of(rows.run, seed);
    if (components.empty() || folds < 2) return result;

    // What a missing structure does to a fit is to make errors look as if they carried over.
    std::vector<double> carries{rows.carry};
    if (std::abs(rows.carry) > 0.1) carries.push_back(kLessCarry * rows.carry);
    std::vector<double> baseline(n, 0.0);
    std::vector<Grams> grams;
    std::vector<std::vector<double>> strengths;
    // Of each carry, for each number of steps: held-out gain over no correction, by block.
    std::vector gains(carries.size(), std::vector(kMostSteps + 1, std::vector<double>(blocks, 0.0)));
    for (std::size_t c = 0; c < carries.size(); ++c) {
        const Design design(rows, components, carries[c]);
        grams.push_back(grams_of(design, components, fold, folds));
        strengths.emplace_back();
        for (std::size_t g = 0; g < components.size(); ++g)
            strengths[c].push_back(strength_for(grams[c].all[g], penalty_of(components[g])));
        for (std::size_t k = 0; k < folds; ++k) {
            Booster booster(design, components, fold, static_cast<int>(k), grams[c], strengths[c]);
            bool more = true;
            double variance = booster.variance();
            for (int m = 0; m <= kMostSteps; ++m) {
                if (m > 0 && more) {
                    more = booster.step();
                    variance = booster.variance();
                }
                const double size = std::log(variance) / 2;
                for (std::size_t i = 0; i < n; ++i) {
                    if (fold[i] != static_cast<int>(k) || !design.used(i)) continue;
                    const double score = -booster.rest(i) * booster.rest(i) / variance / 2 - size;
                    if (c == 0 && m == 0) baseline[i] = score;
                    gains[c][static_cast<std::size_t>(m)][static_cast<std::size_t>(block[i])] +=
                        score - baseline[i];
                }
            }
        }
    }
    // How many steps, and which carry: chosen for each fold by the other folds.
    std::vector<std::size_t> fold_of(blocks, 0);
    for (std::size_t i = 0; i < n; ++i)
        fold_of[static_cast<std::size_t>(block[i])] = static_cast<std::size_t>(fold[i]);
    const auto best_without = [&](std::size_t fold_left) {  // its carry and steps
        double most = 0.0;
        std::pair<std::size_t, std::size_t> best{0, 0};
        for (std::size_t c = 0; c < carries.size(); ++c)
            for (std::size_t m = 0; m <= kMostSteps; ++m) {
                double sum = 0.0;
                for (std::size_t b = 0; b < blocks; ++b)
                    if (fold_of[b] != fold_left) sum += gains[c][m][b];
                if (sum > most) most = sum, best = {c, m};
            }
        return best;
    };
    result.gains.assign(blocks, 0.0);
    for (std::size_t k = 0; k < folds; ++k) {
        const auto [c, m] = best_without(k);
        for (std::size_t b = 0; b < blocks; ++b)
            if (fold_of[b] == k) result.gains[b] = gains[c][m][b];
    }

    const auto [c, steps] = best_without(folds);
    result.carry = carries[c];
    const Design design(rows, components, carries[c]);
    Booster booster(design, components, fold, -1, grams[c], strengths[c]);
    for (std::size_t m = 0; m < steps && booster.step(); ++m)
        continue;
    for (std::size_t g = 0; g < components.size(); ++g) {
        const Eigen::VectorXd& values = booster.values()[g];
        if (values.size() == 0) continue;
        double sum = 0.0, square = 0.0, count = 0.0;
        for (std::size_t i = 0; i < n; ++i) {
            const int cell = components[g].cell[i];
            if (cell < 0 || !std::isfinite(rows.error[i])) continue;
            const double one = values[cell] * weight_of(components[g], i);
            result.correction[i] += one;
            sum += one;
            square += one * one;
            count += 1;
        }
        if (count > 0) result.weight[g] = std::max(square / count - sum * sum / count / count, 0.0);
    }
    return result;
}

}  // namespace puckloop::gap::stats
