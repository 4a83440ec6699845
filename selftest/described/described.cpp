#include "selftest/described/described.h"

#include "base/error.h"
#include "base/random.h"
#include "gap/data/written.h"
#include "gap/kinds/description.h"
#include "gap/models/model.h"
#include "gap/stats/robust.h"
#include "selftest/run_cases.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr std::size_t kRuns = 8, kRows = 60;
constexpr int kMostThings = 4;        // sensors and the like
constexpr double kRowTime = 0.1;      // s
constexpr double kWidest = 1e5;       // of a range that is drawn from
constexpr double kDecades = 20.0;     // ratio of a range's ends from which sizes are drawn by their logarithm
constexpr double kNoiseShare = 0.02;  // of the spread of what is measured
constexpr double kWeakest = 1.0, kStrongest = 3.0;  // ratio to the noise of what is hidden
constexpr double kMostMemory = 0.5;                 // lag-1 correlation of the noise
constexpr double kWalk = 0.2;                       // of a sum: what it gains a row, in units of its noise
constexpr int kTries = 40, kHalvings = 20;
constexpr double kLeastOutside = 0.5;   // of a form's size: what the kind's effects cannot imitate
constexpr double kMostOfChance = 0.35;  // rms change of a probability
constexpr double kNudge = 0.02;         // of a prior's width, for derivatives
constexpr double kMostWrong = 0.05;

using Means = std::vector<std::vector<double>>;

double rms(const Means& means) {
    double sum = 0.0, count = 0.0;
    for (const auto& of : means)
        for (const double one : of)
            sum += one * one, count += 1;
    return count > 0 ? std::sqrt(sum / count) : 0.0;
}

/// One drawn experiment: what was set up, with the measured columns still empty of meaning.
class DrawnDesign {
  public:
    DrawnDesign(const Kind& kind, std::uint64_t seed)
        : kind_(kind), own_(*kind.description()), random_(seed, "described design") {
        experiment_.kind = kind;
        for (std::size_t r = 0; r < kRuns; ++r)
            experiment_.runs.push_back(drawn_run(r));
        model_ = make_model(experiment_);
        neutral_ = model_->predicted(model_->neutral());
        for (std::size_t o = 0; o < neutral_.size(); ++o)
            noise_.push_back(noise_of(o));
    }

    const Model& model() const { return *model_; }
    const Prediction& neutral() const { return neutral_; }
    const Experiment& experiment() const { return experiment_; }
    const std::vector<double>& noise() const { return noise_; }

    /// What changes from the neutral model, an observable each, in units of the noise: means, and what
    /// scatter grows by.
    Means changes(const Prediction& now) const {
        Means all;
        for (std::size_t o = 0; o < now.size(); ++o) {
            auto& of = all.emplace_back();
            for (std::size_t i = 0; i < now[o].mean.size(); ++i) {
                const double mean = (now[o].mean[i] - neutral_[o].mean[i]) / noise_[o];
                of.push_back(std::hypot(mean, sd(now, o, i) / sd(neutral_, o, i) - 1) * (mean < 0 ? -1 : 1));
            }
        }
        return all;
    }

    double sd(const Prediction& now, std::size_t o, std::size_t i) const {
        return std::hypot(noise_[o] * of_row(now[o].factor, i, 1.0), of_row(now[o].extra, i));
    }

    /// The experiment as instruments would write it, where this is true.
    WrittenExperiment measured(const Prediction& truth, std::uint64_t seed) const {
        WrittenExperiment out;
        out.kind = own_.name;
        out.kind_file = own_.file;
        out.title = "drawn from the kind's own formulas";
        RandomStream style(seed, "described noise style");
        const double memory = kMostMemory * style.uniform();
        for (const Run& run : experiment_.runs) {
            WrittenRun written;
            for (const ColumnInfo& column : columns_of(kind_))
                if (run.has(column.name)) written.column(column.name, "").values = run.column(column.name);
            out.runs.push_back(std::move(written));
        }
        for (std::size_t o = 0; o < truth.size(); ++o) {
            const Observable& observable = model_->observables()[o];
            RandomStream random(seed, "described noise " + observable.name);
            double last = 0.0, walk = 0.0;
            for (std::size_t i = 0; i < truth[o].mean.size(); ++i) {
                double& cell = out.runs[observable.run[i]].column(observable.name).values[observable.row[i]];
                if (observable.noise == NoiseKind::Event) {
                    cell = random.uniform() < truth[o].mean[i] ? 1.0 : 0.0;
                    continue;
                }
                if (observable.starts[i] != 0) last = random.normal(), walk = 0.0;
                last = memory * last + std::sqrt(1 - memory * memory) * random.normal();
                if (observable.noise == NoiseKind::Level) walk += kWalk * noise_[o] * random.normal();
                const double quantum = observable.instrument.quantum;
                const double value = truth[o].mean[i] + walk + sd(truth, o, i) * last;
                cell = observable.instrument.clipped(quantum > 0 ? quantum * std::round(value / quantum)
                                                                 : value);
            }
        }
        return out;
    }

  private:
    double drawn(const ColumnInfo& column) {
        const double low = std::max(column.low, -kWidest), high = std::min(column.high, kWidest);
        if (low > 0 && high > kDecades * low) return low * std::pow(high / low, random_.uniform());
        return low + random_.uniform() * (high - low);
    }

    bool in_formulas(std::size_t column) const {
        for (std::size_t f = own_.named_formulas; f < own_.formulas.size(); ++f)
            if (stats::contains(own_.all_used(f), column)) return true;
        return false;
    }

    Run drawn_run(std::size_t r) {
        Run run;
        run.name = run.file = fmt::format("run{:02}.csv", r + 1);
        run.rows = kRows;
        for (std::size_t c = 0; c < own_.columns.size(); ++c) {
            const ColumnInfo& column = own_.columns[c];
            const bool common = c >= own_.own_columns;
            if (column.role == Role::Covariate && !in_formulas(c) && common) continue;
            std::vector<double> values;
            const double level = drawn(column), other = drawn(column);
            for (std::size_t i = 0; i < kRows; ++i) {
                const double share = static_cast<double>(i) / (kRows - 1);
                if (column.index)
                    values.push_back(std::ceil(column.low) +
                                     static_cast<double>(i % static_cast<std::size_t>(things(column))));
                else if (column.role == Role::Covariate)  // goes slowly from one to the other
                    values.push_back(level + share * (other - level));
                else if (column.role == Role::Observable)
                    values.push_back(i % 2 == 0 ? std::max(column.low, -kWidest)
                                                : std::min(column.high, kWidest));
                else
                    values.push_back(drawn(column));
            }
            run.columns[column.name] = std::move(values);
        }
        if (!run.has("t_s"))
            for (std::size_t i = 0; i < kRows; ++i)
                run.columns["t_s"].push_back(kRowTime * static_cast<double>(i));
        return run;
    }

    static int things(const ColumnInfo& column) {
        return std::clamp(static_cast<int>(column.high - std::ceil(column.low)) + 1, 1, kMostThings);
    }

    double noise_of(std::size_t o) const {
        const Observable& observable = model_->observables()[o];
        if (observable.noise == NoiseKind::Event) return 1.0;
        const auto& mean = neutral_[o].mean;
        const double spread = stats::quantile(mean, 0.95) - stats::quantile(mean, 0.05);
        const ColumnInfo* column = find_column(kind_, observable.name);
        const double wide = std::min(column->high, kWidest) - std::max(column->low, -kWidest);
        return std::max(observable.instrument.quantum, kNoiseShare * (spread > 0 ? spread : wide / 2));
    }

    Kind kind_;
    const Description& own_;
    RandomStream random_;
    Experiment experiment_;
    std::unique_ptr<Model> model_;
    Prediction neutral_;
    std::vector<double> noise_;
};

/// Scales `at(share)` by bisection until its ratio to the noise is `asked`; the largest share where it does
/// not get so far.
template <class At>
std::pair<Prediction, double> scaled_to(const DrawnDesign& design, double asked, const At& at) {
    double low = 0.0, high = 1.0;
    Prediction most = at(1.0);
    double reached = rms(design.changes(most));
    if (reached <= asked) return {std::move(most), reached};
    for (int k = 0; k < kHalvings; ++k) {
        const double middle = (low + high) / 2;
        Prediction now = at(middle);
        const double ratio = rms(design.changes(now));
        (ratio > asked ? high : low) = middle;
        if (ratio > asked) most = std::move(now), reached = ratio;
    }
    return {std::move(most), reached};
}

bool all_events(const DrawnDesign& design) {
    return std::ranges::all_of(design.model().observables(),
                               [](const Observable& one) { return one.noise == NoiseKind::Event; });
}

double asked_of(const DrawnDesign& design, RandomStream& random) {
    if (all_events(design)) return kMostOfChance * (0.5 + 0.5 * random.uniform());
    return kWeakest * std::pow(kStrongest / kWeakest, random.uniform());
}

/// One effect's parameters moved together, each by a share of its way to an end that is drawn.
std::pair<Prediction, double> hidden_effect(const DrawnDesign& design, const Effect& effect,
                                            RandomStream& random) {
    const auto neutral = design.model().neutral();
    auto end = neutral;
    for (const EffectParameter& parameter : effect.parameters)
        for (const std::size_t index : design.model().matching(parameter.name)) {
            const double up = parameter.high - neutral[index], down = neutral[index] - parameter.low;
            const bool upwards = down <= 0 || (up > 0 && random.uniform() < 0.5);
            end[index] += (0.3 + 0.7 * random.uniform()) * (upwards ? up : -down);
        }
    return scaled_to(design, asked_of(design, random), [&](double share) {
        auto values = neutral;
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += share * (end[i] - values[i]);
        return design.model().predicted(values);
    });
}

/// Columns of the rows of an observable that vary, from 0 to 1.
std::vector<std::pair<std::string, std::vector<double>>> unit_columns(const DrawnDesign& design,
                                                                      const Observable& observable) {
    std::vector<std::pair<std::string, std::vector<double>>> all;
    for (const ColumnInfo& column : columns_of(design.experiment().kind)) {
        if (column.role == Role::Observable || column.index) continue;
        std::vector<double> values;
        for (std::size_t i = 0; i < observable.y.size(); ++i) {
            const auto& of = design.experiment().runs[observable.run[i]].column(column.name);
            if (!of.empty()) values.push_back(of[observable.row[i]]);
        }
        if (values.size() < observable.y.size() || values.empty()) continue;
        const auto [low, high] = std::ranges::minmax(values);
        if (!(high > low)) continue;
        for (double& value : values)
            value = (value - low) / (high - low);
        all.emplace_back(column.name, std::move(values));
    }
    return all;
}

/// The share of a form's size that no straight combination of the effects' derivatives makes.
double outside_share(const DrawnDesign& design, std::size_t o, const std::vector<double>& form) {
    const auto rows = static_cast<Eigen::Index>(form.size());
    std::vector<Eigen::VectorXd> slopes{Eigen::VectorXd::Ones(rows)};
    for (const Effect& effect : design.experiment().kind.description()->effects)
        for (const EffectParameter& parameter : effect.parameters)
            for (const std::size_t index : design.model().matching(parameter.name))
                for (const double far : {kNudge, 1.0, -1.0}) {
                    auto values = design.model().neutral();
                    values[index] =
                        std::clamp(values[index] + far * parameter.prior_sd, parameter.low, parameter.high);
                    const auto now = design.model().predicted(values);
                    Eigen::VectorXd slope(rows);
                    for (Eigen::Index i = 0; i < rows; ++i)
                        slope(i) = now[o].mean[static_cast<std::size_t>(i)] -
                                   design.neutral()[o].mean[static_cast<std::size_t>(i)];
                    if (slope.norm() > 0) slopes.push_back(slope / slope.norm());
                }
    Eigen::MatrixXd all(rows, static_cast<Eigen::Index>(slopes.size()));
    for (std::size_t k = 0; k < slopes.size(); ++k)
        all.col(static_cast<Eigen::Index>(k)) = slopes[k];
    const Eigen::VectorXd own = Eigen::Map<const Eigen::VectorXd>(form.data(), rows);
    const Eigen::VectorXd left = own - all * all.completeOrthogonalDecomposition().solve(own);
    return own.norm() > 0 ? left.norm() / own.norm() : 0.0;
}

/// A wave, a step or a product of columns on one observable, which the kind's effects cannot imitate.
std::pair<Prediction, double> hidden_outside(const DrawnDesign& design, RandomStream& random,
                                             std::string& words) {
    const std::size_t o = random.below(design.neutral().size());
    const Observable& observable = design.model().observables()[o];
    const auto columns = unit_columns(design, observable);
    if (columns.empty()) throw InputError("", "", "the kind has no column that varies", "one that is set up");
    const double asked = asked_of(design, random);
    for (int k = 0; k < kTries; ++k) {
        const auto& [name, u] = columns[random.below(columns.size())];
        const auto& [other, w] = columns[random.below(columns.size())];
        const std::uint64_t shape = random.below(3);
        const double at = 0.3 + 0.4 * random.uniform(), waves = 1.2 + 1.5 * random.uniform();
        std::vector<double> form;
        for (std::size_t i = 0; i < u.size(); ++i)
            form.push_back(shape == 0   ? std::sin(2 * std::numbers::pi * (waves * u[i] + at))
                           : shape == 1 ? (u[i] < at ? -1.0 : 1.0)
                                        : 4 * (u[i] - 0.5) * (w[i] - 0.5));
        const double outside = outside_share(design, o, form);
        if (outside < kLeastOutside) continue;
        words = shape == 0   ? fmt::format("{}: a wave over {}", observable.name, name)
                : shape == 1 ? fmt::format("{}: a step at some {}", observable.name, name)
                             : fmt::format("{}: {} times {}", observable.name, name, other);
        double size = 0.0;
        for (const double one : form)
            size += one * one;
        size = std::sqrt(size / static_cast<double>(form.size()));
        const bool event = observable.noise == NoiseKind::Event;
        const double most = event ? 1.0 : asked * design.noise()[o] / (size * outside);
        return scaled_to(design, event ? asked : INFINITY, [&, form, most](double share) {
            Prediction now = design.neutral();
            for (std::size_t i = 0; i < form.size(); ++i) {
                now[o].mean[i] += share * most * form[i];
                if (event) now[o].mean[i] = std::clamp(now[o].mean[i], 0.0, 1.0);
            }
            return now;
        });
    }
    throw InputError("", "", "every form tried can be imitated by the kind's effects", "fewer effects");
}

DescribedCase one_case(const Kind& kind, const DescribedTest& test, std::size_t k) {
    const std::uint64_t seed = test.seed * 100'003 + k;
    RandomStream random(seed, "described case");
    const DrawnDesign design(kind, seed);
    DescribedCase one;
    one.hidden = static_cast<HiddenIn>(k % 3);
    Prediction truth = design.neutral();
    const auto& effects = kind.description()->effects;
    if (one.hidden == HiddenIn::Kind) {
        const Effect& effect = effects[k / 3 % effects.size()];
        one.effect = effect.name;
        std::tie(truth, one.ratio) = hidden_effect(design, effect, random);
    } else if (one.hidden == HiddenIn::Outside) {
        std::tie(truth, one.ratio) = hidden_outside(design, random, one.effect);
    }
    const auto said =
        analysed(design.measured(truth, seed), test.scratch / fmt::format("case{:03}", k), seed, test.keep);
    one.wall_s = said.wall_s;
    one.error = said.error;
    one.said = said.error.empty() ? std::string(decision_name(said.verdict.decision)) : "error";
    if (said.error.empty() && said.verdict.decision == Decision::Named)
        for (const Cause& cause : said.verdict.causes)
            one.named.push_back(cause.name);
    return one;
}

template <class Is>
Rate rate(const std::vector<DescribedCase>& cases, HiddenIn hidden, const Is& is) {
    int hits = 0, of = 0;
    for (const DescribedCase& one : cases) {
        if (one.hidden != hidden) continue;
        ++of;
        hits += std::invoke(is, one) ? 1 : 0;
    }
    return rate_of(hits, of);
}

}  // namespace

std::vector<DescribedCase> described_test(const Kind& kind, const DescribedTest& test) {
    return run_all(
        test.cases, test.workers, [&](std::size_t k) { return one_case(kind, test, k); },
        [&](std::size_t, const DescribedCase& one, std::size_t done) {
            if (test.done) test.done(one, done);
        });
}

std::string described_line(const DescribedCase& one) {
    const std::string hidden = one.hidden == HiddenIn::Nothing ? "nothing"
                               : one.hidden == HiddenIn::Kind  ? one.effect
                                                               : "outside: " + one.effect;
    return fmt::format("hidden {} ({:.1f} of the noise): {}{}{}{}", hidden, one.ratio, one.said,
                       one.named.empty() ? "" : fmt::format(" {}", fmt::join(one.named, ", ")),
                       one.wrong() ? "  WRONG" : "", one.error.empty() ? "" : "  " + one.error);
}

std::string described_text(const std::vector<DescribedCase>& cases, const DescribedTest& test) {
    const auto said = [](const char* decision) {
        return [decision](const DescribedCase& one) { return one.said == decision; };
    };
    std::string text = fmt::format("{} cases, {} runs of {} rows each, seed {}; shares with 95 % limits\n",
                                   cases.size(), kRuns, kRows, test.seed);
    text += fmt::format("an effect of the kind is hidden: named first {}, another name first {}\n",
                        share_text(rate(cases, HiddenIn::Kind, &DescribedCase::first_right)),
                        share_text(rate(cases, HiddenIn::Kind, &DescribedCase::wrong)));
    text += fmt::format("nothing is hidden: no effect {}, a name {}\n",
                        share_text(rate(cases, HiddenIn::Nothing, said("no_effect"))),
                        share_text(rate(cases, HiddenIn::Nothing, &DescribedCase::wrong)));
    text += fmt::format("something else is hidden: unexplained {}, a name {}\n",
                        share_text(rate(cases, HiddenIn::Outside, said("unexplained"))),
                        share_text(rate(cases, HiddenIn::Outside, &DescribedCase::wrong)));
    double seconds = 0.0;
    for (const DescribedCase& one : cases)
        seconds = std::max(seconds, one.wall_s);
    return text + fmt::format("the longest verdict took {:.1f} s\n", seconds);
}

bool described_met(const std::vector<DescribedCase>& cases) {
    int wrong = 0;
    for (const DescribedCase& one : cases) {
        if (!one.error.empty()) return false;
        wrong += one.wrong() ? 1 : 0;
    }
    return rate_of(wrong, static_cast<int>(cases.size())).low <= kMostWrong;
}

}  // namespace puckloop::gap::selftest
