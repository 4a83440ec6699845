#include "gap/mission/compare.h"

#include "base/quantile.h"
#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::mission {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kExchanges = 2000;
constexpr int kDraws = 400;
constexpr double kShrink = 0.2;     // of the covariance to its diagonal
constexpr double kSure = 0.05;      // of tests and intervals, one-sided
constexpr double kWins = 0.9;       // of the draws: one effect is distinguished from the next
constexpr double kLeastNats = 3.0;  // a gain below it is taken for none: odds of 20 to 1
constexpr double kMostShare = 4.0;  // of a change: further than so it was not looked at
constexpr double kHalf = 0.5;       // explained less: unexplained

VectorXd mean_of(const Group& group) {
    return group.colwise().mean().transpose();
}

/// Sum of squares about the mean.
MatrixXd scatter_of(const Group& group) {
    const MatrixXd centred = group.rowwise() - group.colwise().mean();
    return centred.transpose() * centred;
}

/// Of one run, pooled over all groups.
MatrixXd covariance_of(const Groups& groups) {
    const Index k = groups.measured.front().cols();
    MatrixXd sum = MatrixXd::Zero(k, k);
    double freedom = 0;
    const auto add = [&](const std::vector<Group>& of) {
        for (const Group& group : of) {
            sum += scatter_of(group);
            freedom += static_cast<double>(group.rows() - 1);
        }
    };
    add(groups.measured);
    add(groups.simulated);
    for (const auto& effect : groups.effects)
        add(effect);
    sum /= std::max(freedom, 1.0);
    const VectorXd diagonal = sum.diagonal();
    MatrixXd shrunk = (1 - kShrink) * sum;
    shrunk.diagonal() = diagonal;
    return shrunk;
}

/// Differences of means of all programs, and what they weigh.
struct Means {
    std::vector<VectorXd> measured;             // less simulated, by program
    std::vector<std::vector<VectorXd>> traces;  // by effect, by program
    std::vector<MatrixXd> weight;               // by program: inverse covariance of `measured`
    // What chance adds to products of traces, and of a trace with `measured`, weighed: a trace is known from
    // so many runs only, and all means are less the same simulated ones.
    std::vector<std::vector<double>> own_chance;  // by effect, by program
    std::vector<double> common_chance;            // by program
};

double runs_in(const Group& group) {
    return static_cast<double>(group.rows());
}

Means means_of(const Groups& groups, const MatrixXd& inverse) {
    Means means;
    for (std::size_t p = 0; p < groups.measured.size(); ++p) {
        const VectorXd base = mean_of(groups.simulated[p]);
        means.measured.push_back(mean_of(groups.measured[p]) - base);
        const double scale = 1 / runs_in(groups.measured[p]) + 1 / runs_in(groups.simulated[p]);
        means.weight.push_back(inverse / scale);
        means.common_chance.push_back(static_cast<double>(inverse.cols()) / runs_in(groups.simulated[p]) /
                                      scale);
    }
    for (const auto& effect : groups.effects) {
        auto& traces = means.traces.emplace_back();
        auto& chance = means.own_chance.emplace_back();
        for (std::size_t p = 0; p < groups.measured.size(); ++p) {
            traces.push_back(mean_of(effect[p]) - mean_of(groups.simulated[p]));
            const double scale = 1 / runs_in(groups.measured[p]) + 1 / runs_in(groups.simulated[p]);
            chance.push_back(static_cast<double>(inverse.cols()) / runs_in(effect[p]) / scale);
        }
    }
    return means;
}

using Chosen = std::vector<std::size_t>;  // effects

/// Shares that fit best, of programs for which `part` says so. Products of noisy means are on average larger
/// than those of the means, which would make every share too small: what chance adds is taken off (Fuller,
/// Measurement Error Models, 1987), as long as most of the product is left.
template <class Part>
VectorXd shares_of(const Means& means, const Chosen& chosen, Part part) {
    const auto n = static_cast<Index>(chosen.size());
    MatrixXd normal = MatrixXd::Zero(n, n);
    VectorXd right = VectorXd::Zero(n);
    for (std::size_t p = 0; p < means.measured.size(); ++p) {
        if (!part(p)) continue;
        for (Index i = 0; i < n; ++i) {
            const VectorXd weighted = means.weight[p] * means.traces[chosen[static_cast<std::size_t>(i)]][p];
            right(i) += weighted.dot(means.measured[p]);
            for (Index j = 0; j < n; ++j)
                normal(i, j) += weighted.dot(means.traces[chosen[static_cast<std::size_t>(j)]][p]);
        }
    }
    MatrixXd chance = MatrixXd::Zero(n, n);
    double common = 0.0;
    for (std::size_t p = 0; p < means.measured.size(); ++p) {
        if (!part(p)) continue;
        common += means.common_chance[p];
        for (Index i = 0; i < n; ++i)
            chance(i, i) += means.own_chance[chosen[static_cast<std::size_t>(i)]][p];
    }
    chance.array() += common;
    constexpr double kMostOff = 0.5;
    if (((normal.diagonal() * kMostOff - chance.diagonal()).array() > 0).all()) {
        normal -= chance;
        right.array() -= common;
    }
    normal.diagonal().array() += 1e-9 * (1.0 + normal.diagonal().maxCoeff());
    return normal.ldlt().solve(right).cwiseMax(-kMostShare).cwiseMin(kMostShare);
}

VectorXd left_of(const Means& means, const Chosen& chosen, const VectorXd& shares, std::size_t program) {
    VectorXd left = means.measured[program];
    for (std::size_t i = 0; i < chosen.size(); ++i)
        left -= shares(static_cast<Index>(i)) * means.traces[chosen[i]][program];
    return left;
}

/// Nats that the effects gain on programs that had no part in fitting them.
double gain_of(const Means& means, const Chosen& chosen) {
    double gain = 0.0;
    for (std::size_t p = 0; p < means.measured.size(); ++p) {
        const VectorXd shares = shares_of(means, chosen, [p](std::size_t other) { return other != p; });
        const VectorXd left = left_of(means, chosen, shares, p);
        gain += 0.5 * (means.measured[p].dot(means.weight[p] * means.measured[p]) -
                       left.dot(means.weight[p] * left));
    }
    return gain;
}

/// One program becomes two, of every other measured and simulated run.
Groups halved(const Groups& groups) {
    const auto half = [](const Group& group, Index first) {
        Group part((group.rows() - first + 1) / 2, group.cols());
        for (Index i = first, to = 0; i < group.rows(); i += 2, ++to)
            part.row(to) = group.row(i);
        return part;
    };
    const auto both = [&](const std::vector<Group>& of) {
        return std::vector<Group>{half(of.front(), 0), half(of.front(), 1)};
    };
    Groups two{both(groups.measured), both(groups.simulated), {}};
    for (const auto& effect : groups.effects)
        two.effects.push_back(both(effect));
    return two;
}

Group drawn(const Group& group, RandomStream& random) {
    Group sample(group.rows(), group.cols());
    for (Index i = 0; i < group.rows(); ++i)
        sample.row(i) = group.row(static_cast<Index>(random.below(static_cast<std::uint64_t>(group.rows()))));
    return sample;
}

Groups drawn(const Groups& groups, RandomStream& random) {
    Groups sample = groups;
    const auto draw = [&](std::vector<Group>& of) {
        for (Group& group : of)
            group = drawn(group, random);
    };
    draw(sample.measured);
    draw(sample.simulated);
    for (auto& effect : sample.effects)
        draw(effect);
    return sample;
}

/// Difference of means of two samples, in standard errors by their own spread.
double errors_between(const Eigen::Ref<const VectorXd>& a, const Eigen::Ref<const VectorXd>& b) {
    const auto spread = [](const Eigen::Ref<const VectorXd>& of) {
        const double n = static_cast<double>(of.size());
        return (of.array() - of.mean()).square().sum() / (n - 1) / n;
    };
    const double error = std::sqrt(spread(a) + spread(b));
    return error > 0 ? (a.mean() - b.mean()) / error : 0.0;
}

/// The largest difference of each exchange, against which all are held.
std::vector<double> exchanged(const std::vector<Group>& measured, const std::vector<Group>& simulated,
                              RandomStream random) {
    std::vector<double> largest;
    for (int draw = 0; draw < kExchanges; ++draw) {
        double most = 0.0;
        for (std::size_t p = 0; p < measured.size(); ++p) {
            const Index n = measured[p].rows(), m = simulated[p].rows();
            Group all(n + m, measured[p].cols());
            all << measured[p], simulated[p];
            std::vector<Index> order(static_cast<std::size_t>(n + m));
            std::iota(order.begin(), order.end(), Index{0});
            for (std::size_t i = order.size(); i > 1; --i)
                std::swap(order[i - 1], order[random.below(i)]);
            Group mixed(n + m, all.cols());
            for (Index i = 0; i < n + m; ++i)
                mixed.row(i) = all.row(order[static_cast<std::size_t>(i)]);
            for (Index k = 0; k < all.cols(); ++k)
                most = std::max(most, std::abs(errors_between(mixed.col(k).head(n), mixed.col(k).tail(m))));
        }
        largest.push_back(most);
    }
    std::sort(largest.begin(), largest.end());
    return largest;
}

double p_of(const std::vector<double>& largest, double errors) {
    const auto above = static_cast<double>(
        largest.end() - std::lower_bound(largest.begin(), largest.end(), std::abs(errors)));
    return (above + 1) / (static_cast<double>(largest.size()) + 1);
}

std::vector<Difference> differences_of(const Groups& groups, const std::vector<double>& largest) {
    std::vector<Difference> all;
    for (std::size_t p = 0; p < groups.measured.size(); ++p)
        for (Index k = 0; k < groups.measured[p].cols(); ++k) {
            const auto measured = groups.measured[p].col(k), simulated = groups.simulated[p].col(k);
            const double errors = errors_between(measured, simulated);
            all.push_back({p, static_cast<std::size_t>(k), measured.mean(), simulated.mean(), errors,
                           p_of(largest, errors)});
        }
    std::stable_sort(all.begin(), all.end(), [](const Difference& a, const Difference& b) {
        return std::abs(a.errors) > std::abs(b.errors);
    });
    return all;
}

/// With what the effects account for taken off the measured runs.
std::vector<Group> corrected(const Groups& groups, const Means& means, const Chosen& chosen,
                             const VectorXd& shares) {
    std::vector<Group> runs = groups.measured;
    for (std::size_t p = 0; p < runs.size(); ++p) {
        VectorXd shift = VectorXd::Zero(runs[p].cols());
        for (std::size_t i = 0; i < chosen.size(); ++i)
            shift += shares(static_cast<Index>(i)) * means.traces[chosen[i]][p];
        runs[p].rowwise() -= shift.transpose();
    }
    return runs;
}

/// Everything that is drawn again and again.
class Effects {
  public:
    Effects(const Groups& groups, std::uint64_t seed)
        : groups_(groups.measured.size() == 1 ? halved(groups) : groups),
          inverse_(covariance_of(groups).inverse()),
          whole_(means_of(groups_, inverse_)) {
        RandomStream random(seed, "gap/mission/draws");
        for (int draw = 0; draw < kDraws; ++draw)
            draws_.push_back(means_of(drawn(groups_, random), inverse_));
    }

    const Means& whole() const { return whole_; }
    std::size_t count() const { return groups_.effects.size(); }

    /// What each further effect gains beside those that were taken, the best first.
    std::vector<Amount> beside(const Chosen& taken) const {
        std::vector<Amount> amounts;
        std::vector<std::vector<double>> gains;  // by effect, by draw
        const auto gain_before = [&](const Means& means) {
            return taken.empty() ? 0.0 : gain_of(means, taken);
        };
        const double before = gain_before(whole_);
        std::vector<double> drawn_before;
        for (const Means& draw : draws_)
            drawn_before.push_back(gain_before(draw));
        for (std::size_t effect = 0; effect < count(); ++effect) {
            if (std::find(taken.begin(), taken.end(), effect) != taken.end()) continue;
            Chosen with = taken;
            with.push_back(effect);
            Amount amount{.effect = effect};
            amount.gain = gain_of(whole_, with) - before;
            auto& drawn_gains = gains.emplace_back();
            for (std::size_t d = 0; d < draws_.size(); ++d)
                drawn_gains.push_back(gain_of(draws_[d], with) - drawn_before[d]);
            amount.gain_low = lower(drawn_gains, amount.gain);
            fill_shares(amount, with);
            amounts.push_back(amount);
        }
        for (std::size_t i = 0; i < amounts.size(); ++i) {
            double wins = 0;
            for (std::size_t d = 0; d < draws_.size(); ++d) {
                bool first = true;
                for (std::size_t j = 0; j < amounts.size(); ++j)
                    first = first && (j == i || gains[j][d] < gains[i][d]);
                wins += first ? 1 : 0;
            }
            amounts[i].wins = wins / static_cast<double>(draws_.size());
        }
        std::stable_sort(amounts.begin(), amounts.end(),
                         [](const Amount& a, const Amount& b) { return a.gain > b.gain; });
        return amounts;
    }

    /// The share of the last of `chosen`, fitted with the others to all programs.
    void fill_shares(Amount& amount, const Chosen& chosen) const {
        const auto all = [](std::size_t) { return true; };
        const auto at = std::find(chosen.begin(), chosen.end(), amount.effect) - chosen.begin();
        amount.share = shares_of(whole_, chosen, all)(at);
        std::vector<double> values;
        for (const Means& draw : draws_)
            values.push_back(shares_of(draw, chosen, all)(at));
        amount.low = amount.share + quantile(values, kSure) - quantile(values, 0.5);
        amount.high = amount.share + quantile(values, 1 - kSure) - quantile(values, 0.5);
    }

  private:
    /// A draw has the chance of runs twice, the sample's and its own: its gains scatter about the sample's
    /// gain and more. The distance below the draws' middle is what the sample's may be off.
    static double lower(const std::vector<double>& values, double gain) {
        return gain - (quantile(values, 0.5) - quantile(values, kSure));
    }

    Groups groups_;
    MatrixXd inverse_;
    Means whole_;
    std::vector<Means> draws_;
};

bool sure(const Amount& amount) {
    return amount.gain > kLeastNats && amount.gain_low > 0 && (amount.low > 0 || amount.high < 0);
}

/// Squared distance of the means beyond what chance makes, nats.
double beyond_chance(const Means& means) {
    double sum = 0.0;
    for (std::size_t p = 0; p < means.measured.size(); ++p)
        sum += 0.5 * (means.measured[p].dot(means.weight[p] * means.measured[p]) -
                      static_cast<double>(means.measured[p].size()));
    return sum;
}

}  // namespace

Comparison compare(const Groups& groups, std::uint64_t seed) {
    Comparison result;
    const auto largest =
        exchanged(groups.measured, groups.simulated, RandomStream(seed, "gap/mission/exchanges"));
    result.differences = differences_of(groups, largest);
    result.p = result.differences.front().p;
    result.left_p = result.p;
    double worst = 0.0;
    for (std::size_t p = 0; p < groups.measured.size(); ++p)
        worst =
            std::max(worst, std::sqrt(1 / runs_in(groups.measured[p]) + 1 / runs_in(groups.simulated[p])));
    constexpr double kPower = 1.645;  // normal deviate of 19 of 20
    result.visible = (quantile(largest, 1 - kSure) + kPower) * worst;
    if (result.p > kSure) return result;
    if (groups.effects.empty()) {
        result.finding = Finding::Unexplained;
        return result;
    }
    const Effects effects(groups, seed);
    result.alone = effects.beside({});
    Chosen taken;
    std::vector<Amount> next = result.alone;
    while (!next.empty() && sure(next.front())) {
        if (taken.empty() && next.front().wins < kWins)
            for (const Amount& other : next)
                if (other.effect != next.front().effect && sure(other) && other.wins > 1 - kWins)
                    result.as_good.push_back(other.effect);
        taken.push_back(next.front().effect);
        next = effects.beside(taken);
    }
    if (!taken.empty()) {
        const VectorXd shares = shares_of(effects.whole(), taken, [](std::size_t) { return true; });
        Groups left = groups;
        const Means whole = means_of(
            groups, MatrixXd::Identity(groups.measured.front().cols(), groups.measured.front().cols()));
        left.measured = corrected(groups, whole, taken, shares);
        const auto chance = exchanged(left.measured, left.simulated, RandomStream(seed, "gap/mission/left"));
        result.left_p = differences_of(left, chance).front().p;
        for (const std::size_t effect : taken) {
            const auto alone = std::find_if(result.alone.begin(), result.alone.end(),
                                            [&](const Amount& amount) { return amount.effect == effect; });
            Amount amount = *alone;
            effects.fill_shares(amount, taken);
            result.together.push_back(amount);
        }
        const double all = beyond_chance(effects.whole());
        result.explained = all > 0 ? std::clamp(gain_of(effects.whole(), taken) / all, 0.0, 1.0) : 0.0;
    }
    if (taken.empty() || result.explained < kHalf)
        result.finding = Finding::Unexplained;
    else
        result.finding = result.as_good.empty() ? Finding::Named : Finding::CannotTell;
    return result;
}

}  // namespace puckloop::gap::mission
