#include "gap/residual_model/free_form.h"

#include "base/random.h"
#include "gap/evidence/thresholds.h"
#include "gap/findings/quantities.h"
#include "gap/fit/study.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/residual_model/sum_form.h"
#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap {

namespace {

using namespace thresholds;

constexpr std::size_t kTerms = 4;           // reported, the largest first
constexpr double kLeastTerm = 0.05;         // of the correction's variance
constexpr std::ptrdiff_t kLeastEvents = 5;  // of the rarer kind: of fewer nothing is learnt
constexpr std::size_t kMostRows = 12000;    // beyond, stretches are left out

/// Errors of one observable or more, rows in chains.
struct Errors {
    std::string observable, unit;
    std::string said_in;  ///< unit in which a person reads them
    stats::ErrorRows rows;
    Series at;  // run and row of each
    std::vector<char> starts;
    std::vector<double> scale, level;  ///< noise and prediction, the observable's unit
    double quantum = 0.0;              ///< that it is rounded to
    bool waits = false;                ///< of a law to one side, about a zero that is free
};

/// Where a zero is free, errors of a law to one side lie about it, not about that law's mode.
void centre(std::vector<double>& errors) {
    const double middle = stats::mean(stats::winsorised(stats::finite(errors)));
    for (double& one : errors)
        one -= middle;
}

Errors errors_of(const Observable& observable, const Predicted& predicted, const NoiseParameters& noise,
                 const RowCosts& costs) {
    Errors e;
    e.observable = observable.name;
    e.unit = observable.unit;
    e.said_in = observable.noise == NoiseKind::Event ? kShare : observable.unit;
    e.quantum = observable.instrument.quantum;
    const bool whitened = observable.noise != NoiseKind::Carry || predicted.line_amplitude > 0;
    e.rows.carry = whitened ? 0.0 : noise.carry;
    e.rows.trimmed = observable.noise != NoiseKind::Event;
    for (std::size_t i = 0; i < observable.y.size(); ++i) {
        const bool clipped = observable.instrument.at_end(observable.y[i]);
        const double sd = row_sd(observable, predicted, noise, i);
        const bool begins = observable.noise == NoiseKind::Level && observable.starts[i] != 0;
        e.rows.error.push_back(begins     ? NAN
                               : whitened ? costs.innovation[i]
                               : clipped  ? NAN
                                          : (observable.y[i] - predicted.mean[i]) / sd);
        // Over missing rows less is carried over than from row to row: nothing is taken to be.
        const bool next = observable.steps.empty() || observable.steps[i] == 1;
        e.rows.follows.push_back(observable.starts[i] == 0 && next ? 1 : 0);
        e.rows.run.push_back(static_cast<int>(observable.run[i]));
        e.starts.push_back(observable.starts[i]);
        e.scale.push_back(sd);
        e.level.push_back(predicted.mean[i]);
    }
    e.at.run = observable.run;
    e.at.row = observable.row;
    e.waits = observable.waits;
    if (e.waits) centre(e.rows.error);
    return e;
}

void append(Errors& to, const Errors& from) {
    const auto add = [](auto& a, const auto& b) { a.insert(a.end(), b.begin(), b.end()); };
    add(to.rows.error, from.rows.error);
    add(to.rows.follows, from.rows.follows);
    add(to.rows.run, from.rows.run);
    add(to.at.run, from.at.run);
    add(to.at.row, from.at.row);
    add(to.starts, from.starts);
    add(to.scale, from.scale);
}

/// Along and across the heading instead of x and y: what a robot does wrong goes with it.
std::vector<stats::Component> turned_with_robot(const Experiment& experiment, const Errors& errors,
                                                std::size_t rows_of_x,
                                                const std::vector<stats::Component>& components) {
    std::vector<double> along, across;
    for (std::size_t i = 0; i < errors.at.run.size(); ++i) {
        const auto& theta = experiment.runs[errors.at.run[i]].column("theta_rad");
        const double heading = theta.empty() ? NAN : theta[errors.at.row[i]];
        const double c = std::isfinite(heading) ? std::cos(heading) : 0.0,
                     s = std::isfinite(heading) ? std::sin(heading) : 0.0;
        along.push_back(i < rows_of_x ? c : s);
        across.push_back(i < rows_of_x ? -s : c);
    }
    std::vector<stats::Component> all;
    for (const auto& component : components) {
        if (component.pair) continue;  // twice as many, on twice the rows
        all.push_back(component);
        all.back().qualifier += " (along the heading)";
        all.back().weight = along;
        all.push_back(component);
        all.back().qualifier += " (across the heading)";
        all.back().weight = across;
    }
    return all;
}

/// The same cells again for what goes in proportion to the prediction.
void add_proportional(const Errors& errors, std::vector<stats::Component>& components) {
    double squares = 0.0;
    for (const double level : errors.level)
        squares += level * level;
    const double rms = std::sqrt(squares / std::max<double>(static_cast<double>(errors.level.size()), 1.0));
    if (!(rms > 0)) return;
    std::vector<double> weight;
    for (const double level : errors.level)
        weight.push_back(level / rms);
    const std::size_t count = components.size();
    for (std::size_t g = 0; g < count; ++g) {
        if (components[g].pair) continue;
        components.push_back(components[g]);
        components.back().qualifier += " (in proportion to the prediction)";
        components.back().weight = weight;
    }
}

/// One number a cell, in the observable's unit, and its course in words, in `unit`.
FreeFormTerm term_of(const stats::Component& component, const std::vector<double>& correction,
                     const std::vector<double>& scale, double share, const std::string& unit) {
    FreeFormTerm term;
    term.over = component.name + component.qualifier;
    term.share = share;
    const auto weight = [&](std::size_t i) { return stats::weight_of(component, i); };
    const auto sums = stats::sums_of_cells(
                   component, [&](std::size_t i) { return weight(i) * correction[i] * scale[i]; }),
               weights =
                   stats::sums_of_cells(component, [&](std::size_t i) { return weight(i) * weight(i); });
    stats::Profile profile;
    for (std::size_t k = 0; k < sums.size(); ++k) {
        if (!(weights[k] > 0)) continue;
        term.where.push_back(component.where[k]);
        term.values.push_back(sums[k] / weights[k]);
        if (!component.ordered) continue;
        profile.x.push_back(component.at[k]);
        profile.y.push_back(term.values.back());
        profile.error.push_back(0.0);
    }
    if (term.values.empty()) return term;
    const auto [low, high] = std::ranges::minmax_element(term.values);
    const auto at = [&](auto one) { return term.where[static_cast<std::size_t>(one - term.values.begin())]; };
    term.shape =
        fmt::format("{} at {}, {} at {}", change(*high, unit), at(high), change(*low, unit), at(low));
    if (component.ordered && profile.x.size() > 2)
        term.shape = stats::shape_words(profile, component.name) + " (" + term.shape + ")";
    return term;
}

/// The same errors with what is new in each row exchanged inside its run: carried over as before, as wild as
/// before, each run as far off as before, and no function of any covariate.
stats::ErrorRows exchanged(stats::ErrorRows rows, RandomStream& random) {
    std::vector<double>& error = rows.error;
    const auto carries = [&](std::size_t i) {
        return rows.follows[i] != 0 && std::isfinite(error[i]) && std::isfinite(error[i - 1]);
    };
    std::vector<double> fresh;
    std::vector<std::size_t> at;
    const auto exchange = [&] {
        stats::shuffle(std::span(fresh), random);
        for (std::size_t k = 0; k < at.size(); ++k)
            error[at[k]] = rows.carry * error[at[k] - 1] + fresh[k];
        fresh.clear();
        at.clear();
    };
    for (std::size_t i = 0; i < error.size(); ++i) {
        if (i > 0 && rows.run[i] != rows.run[i - 1]) exchange();
        if (!carries(i)) continue;
        at.push_back(i);
        fresh.push_back(error[i] - rows.carry * error[i - 1]);
    }
    exchange();
    return rows;
}

/// Does a gain stand as clear of the best that exchanged errors make as of nothing?
bool beyond_exchanged(double gain, const Errors& errors, const std::vector<stats::Component>& components,
                      std::uint64_t seed) {
    RandomStream random(seed, "free form of " + errors.observable);
    for (int k = 0; k < thresholds::kExchanges && gain > kClearForm; ++k) {
        const auto rows = exchanged(errors.rows, random);
        if (gain_of(stats::boosted(rows, components, seed).gains).sum > gain - kClearForm) return false;
    }
    return gain > kClearForm;
}

/// `law`: the errors follow one, so that they may be exchanged.
FreeForm form_of(const Errors& errors, const std::vector<stats::Component>& components, std::uint64_t seed,
                 bool law = true) {
    const stats::Boosted fit = stats::boosted(errors.rows, components, seed);
    FreeForm form;
    form.observable = errors.observable;
    form.unit = errors.unit;
    const Gain gain = gain_of(fit.gains);
    form.gain = gain.sum;
    form.sd = gain.sd;
    const double all = std::accumulate(fit.weight.begin(), fit.weight.end(), 0.0);
    const auto order = stats::ordered(
        components.size(), [&](std::size_t a, std::size_t b) { return fit.weight[a] > fit.weight[b]; });
    double squares = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < fit.correction.size(); ++i)
        if (std::isfinite(errors.rows.error[i])) {
            squares += fit.correction[i] * fit.correction[i];
            rows += 1;
        }
    form.size = rows > 0 ? std::sqrt(squares / rows) : 0.0;
    for (std::size_t k = 0; k < std::min(kTerms, order.size()); ++k)
        if (fit.weight[order[k]] > kLeastTerm * all)
            form.terms.push_back(term_of(components[order[k]], fit.correction, errors.scale,
                                         fit.weight[order[k]] / all, errors.said_in));
    // What only a few runs can show is clear when several gain by it and none loses, or where the same errors
    // exchanged come nowhere near.
    const bool rounding = form.size * stats::median(errors.scale) < errors.quantum / std::sqrt(12.0);
    form.clear = !rounding && form.gain > kClearForm && !form.terms.empty() &&
                 (form.gain > kFormErrors * form.sd || gain.in_several() ||
                  (law && beyond_exchanged(form.gain, errors, components, seed)));
    if (form.clear) form.shape = form.terms.front().shape;
    return form;
}

/// Do wild values (not 0) keep together within their chains, more than rare chances that know nothing of each
/// other? Of k among n in a chain, k (k - 1) / n neighbours are expected.
bool in_bursts(const stats::ErrorRows& rows) {
    double seen = 0.0, expected = 0.0, n = 0.0, k = 0.0;
    bool last = false;
    for (std::size_t i = 0; i < rows.error.size(); ++i) {
        if (std::isfinite(rows.error[i])) {
            const bool wild = rows.error[i] != 0.0;
            seen += wild && last ? 1 : 0;
            n += 1;
            k += wild ? 1 : 0;
            last = wild;
        }
        if (i + 1 < rows.error.size() && rows.follows[i + 1] != 0) continue;
        expected += n > 0 ? k * (k - 1) / n : 0.0;
        n = k = 0.0;
        last = false;
    }
    return seen > kManyTimes * expected && seen - expected > kManyDeviations * std::sqrt(expected + 1);
}

/// Single readings far astray, always to one side or always in one place, are a structure that means do not
/// show: -1, 0 or 1 for each row in place of its error.
FreeForm wild_form(Errors errors, const std::vector<stats::Component>& components, std::uint64_t seed) {
    FreeForm form;
    form.observable = "outliers of " + errors.observable;
    form.gain = -INFINITY;
    const std::vector<double> known = stats::finite(errors.rows.error);
    const double unit = std::max(stats::robust_scale(known), 1.0);
    double low = 0.0, high = 0.0, far = 0.0;  // low and high: stretches of wild values count once
    double last = 0.0, rows = 0.0;
    for (std::size_t i = 0; i < errors.rows.error.size(); ++i) {
        double& error = errors.rows.error[i];
        if (!std::isfinite(error)) continue;
        const double wild = error > kWild * unit ? 1.0 : error < -kWild * unit ? -1.0 : 0.0;
        const bool fresh = errors.rows.follows[i] == 0 || wild != last;
        far += std::abs(error) > kFar * unit ? 1 : 0;
        low += fresh && wild < 0 ? 1 : 0;
        high += fresh && wild > 0 ? 1 : 0;
        rows += std::abs(wild);
        error = last = wild;
    }
    if (rows < kLeastWild) return form;
    const bool bursts = in_bursts(errors.rows);
    if (errors.waits) centre(errors.rows.error);
    const double sd = std::sqrt(rows / static_cast<double>(known.size()));
    for (double& error : errors.rows.error)
        error /= sd;
    errors.scale.assign(errors.scale.size(), sd);
    errors.quantum = 0.0;
    errors.observable = form.observable;
    errors.unit = "of the readings";
    errors.said_in = kShare;
    errors.rows.carry = 0.0;
    errors.rows.trimmed = false;
    form = form_of(errors, components, seed, false);
    // A few rows in thousands: where they fall by chance may gain more than a normal law of them lets expect.
    form.clear = form.clear && beyond_exchanged(form.gain, errors, components, seed);
    form.wild = true;
    form.bursts = bursts;
    const bool one_sided = std::pow(0.5, low + high - 1) < thresholds::kSure && std::min(low, high) == 0;
    if (!form.clear && !errors.waits && (one_sided || far >= kLeastWild)) {
        form.clear = true;
        form.gain = 0.0;
        form.shape = fmt::format("{:.0f} of {} readings go far astray, {}", rows, known.size(),
                                 high == 0  ? "all of them down"
                                 : low == 0 ? "all of them up"
                                            : "up and down");
    }
    return form;
}

/// Events that (nearly) always or never happen have no noise to measure a correction by.
bool enough_events(const Observable& observable) {
    if (observable.noise != NoiseKind::Event) return true;
    const auto yes = std::ranges::count_if(observable.y, [](double y) { return y > 0.5; });
    const auto no = static_cast<std::ptrdiff_t>(observable.y.size()) - yes;
    return std::min(yes, no) >= kLeastEvents;
}

}  // namespace

std::vector<FreeForm> free_forms_of(const Experiment& experiment, const Model& model, const State& state,
                                    std::uint64_t seed, std::span<const std::string> only) {
    const Prediction prediction = model.predicted(state.values);
    const auto costs = costs_at(model, state, prediction);
    std::vector<FreeForm> forms;
    std::vector<Errors> track;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        if (!only.empty() && !stats::contains(only, observable.name)) continue;
        if (observable.fixed_sd > 0 || observable.y.size() > 4 * kMostRows) continue;
        if (!enough_events(observable)) continue;
        if (is_rounding(observable, state.noise[o])) continue;
        Errors errors = errors_of(observable, prediction[o], state.noise[o], costs[o]);
        if (observable.name == "x_m" || observable.name == "y_m") {
            track.push_back(std::move(errors));
            continue;
        }
        auto components = free_form_cells(experiment, errors.at, errors.starts);
        if (observable.noise == NoiseKind::Level) {
            FreeForm rows = form_of(errors, components, seed),
                     sums = sum_form_of(experiment, model, state, prediction, o, components, seed);
            forms.push_back(sums.gain > rows.gain ? std::move(sums) : std::move(rows));
            continue;
        }
        if (observable.noise == NoiseKind::Carry) add_proportional(errors, components);
        forms.push_back(form_of(errors, components, seed));
        if (observable.noise == NoiseKind::Carry) forms.push_back(wild_form(errors, components, seed));
    }
    if (track.size() == 2) {
        Errors& both = track.front();
        const std::size_t rows_of_x = both.rows.error.size();
        append(both, track.back());
        both.observable = "place";
        forms.push_back(form_of(
            both,
            turned_with_robot(experiment, both, rows_of_x, free_form_cells(experiment, both.at, both.starts)),
            seed));
    }
    std::ranges::stable_sort(forms, std::ranges::greater{}, &FreeForm::gain);
    return forms;
}

}  // namespace puckloop::gap
