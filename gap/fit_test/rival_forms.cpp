#include "gap/fit_test/rival_forms.h"

#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/fit_test/scores.h"
#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kSameForm = 0.995;  // correlation of what two forms do to the innovations
constexpr int kRounds = 8;           // of weighted least squares

/// What an effect does in a row, and where in its run the row lies.
struct RivalRow {
    double effect, before;  ///< in units of its root mean square; `before`: of the row before
    double place;           ///< 0..1
    double middle;          ///< median of its size
};

struct Form {
    const char* words;
    double (*bend)(const RivalRow&);
};

/// The effect's own first.
const Form kForms[] = {
    {"its own", [](const RivalRow& r) { return r.effect; }},
    {"its root", [](const RivalRow& r) { return std::copysign(std::sqrt(std::abs(r.effect)), r.effect); }},
    {"its square", [](const RivalRow& r) { return r.effect * std::abs(r.effect); }},
    {"with a soft end", [](const RivalRow& r) { return std::tanh(r.effect); }},
    {"beyond a threshold only",
     [](const RivalRow& r) { return std::copysign(std::max(std::abs(r.effect) - r.middle, 0.0), r.effect); }},
    {"a row later", [](const RivalRow& r) { return r.before; }},
    {"growing through the run", [](const RivalRow& r) { return r.effect * r.place; }},
    {"dying away through the run", [](const RivalRow& r) { return r.effect * std::exp(-3 * r.place); }},
};

/// Rows of an observable as an effect moves them; of a sum what each row adds.
std::vector<RivalRow> rows_of(const Observable& o, const std::vector<double>& with,
                              const std::vector<double>& without, double& rms) {
    const std::size_t n = o.y.size();
    std::vector<RivalRow> rows(n);
    std::vector<double> sizes;
    double squares = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const bool begins = i == 0 || o.starts[i] != 0;
        double moved = with[i] - without[i];
        if (adds_up(o)) moved = begins ? 0.0 : moved - (with[i - 1] - without[i - 1]);
        if (!std::isfinite(moved)) moved = 0.0;
        rows[i].effect = moved;
        rows[i].before = begins ? moved : rows[i - 1].effect;
        squares += moved * moved;
        sizes.push_back(std::abs(moved));
    }
    rms = std::sqrt(squares / std::max<double>(static_cast<double>(n), 1.0));
    if (!(rms > 0)) return rows;
    const double middle = stats::median(sizes) / rms;
    for (const stats::Stretch& run : stats::stretches_of(o.run))
        for (std::size_t i = run.first; i < run.last; ++i) {
            rows[i].place =
                static_cast<double>(i - run.first) / std::max(static_cast<double>(run.size()) - 1, 1.0);
            rows[i].effect /= rms;
            rows[i].before /= rms;
            rows[i].middle = middle;
        }
    return rows;
}

/// What a form adds to each row's mean.
std::vector<double> shift_of(const Observable& o, const std::vector<RivalRow>& rows, const Form& form,
                             double rms) {
    std::vector<double> shift;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const bool sums = adds_up(o) && i > 0 && o.starts[i] == 0;
        shift.push_back(form.bend(rows[i]) + (sums ? shift.back() : 0.0));
    }
    for (double& one : shift)
        one *= rms;
    return shift;
}

/// One observable that the effect moves: what is left without it, and how a form answers.
struct Part {
    std::size_t observable;
    double freedom;                            ///< of Student's t
    std::vector<double> rest;                  ///< innovations without the effect
    std::vector<std::vector<double>> answers;  ///< a form each
};

double cost(double z, double freedom) {
    return (freedom + 1) / 2 * std::log1p(z * z / freedom);
}

/// The amplitude of a form that fits best, over all observables.
double amplitude_of(const std::vector<Part>& parts, std::size_t form) {
    double amplitude = 0.0;
    for (int round = 0; round < kRounds; ++round) {
        double pull = 0.0, information = 1e-12;
        for (const Part& part : parts)
            for (std::size_t i = 0; i < part.rest.size(); ++i) {
                const double h = part.answers[form][i], z = part.rest[i] - amplitude * h;
                const double weight = (part.freedom + 1) / (part.freedom + z * z);
                pull += weight * h * part.rest[i];
                information += weight * h * h;
            }
        amplitude = pull / information;
    }
    return amplitude;
}

std::vector<double> flat(const std::vector<Part>& parts, std::size_t form) {
    std::vector<double> all;
    for (const Part& part : parts)
        all.insert(all.end(), part.answers[form].begin(), part.answers[form].end());
    return all;
}

}  // namespace

std::vector<RivalForm> rival_forms(const Study& study, const Fit& fit, std::size_t effect) {
    if (is_outlier(study, effect)) return {};
    const auto [with, without] = contrast(study, fit, effect);
    std::vector<Part> parts;
    for (std::size_t k = 0; k < with.size(); ++k) {
        const Observable& o = study.model().observables()[k];
        if (o.noise == NoiseKind::Event || o.fixed_sd > 0) continue;
        double rms = 0.0;
        const auto rows = rows_of(o, with[k].mean, without[k].mean, rms);
        if (!(rms > 0)) continue;
        const NoiseParameters& noise = fit.fitted.state.noise[k];
        const Scores scores(o, with[k], noise);
        Part part{k, std::exp(noise.log_tail), scores.innovations(), {}};
        for (const Form& form : kForms)
            part.answers.push_back(scores.answers(shift_of(o, rows, form, rms)));
        for (std::size_t i = 0; i < part.rest.size(); ++i)
            part.rest[i] += part.answers[0][i];
        parts.push_back(std::move(part));
    }
    std::vector<RivalForm> forms;
    if (parts.empty()) return forms;
    const auto own = flat(parts, 0);
    const double own_amplitude = amplitude_of(parts, 0);
    for (std::size_t f = 1; f < std::size(kForms); ++f) {
        if (!(std::abs(stats::correlation(own, flat(parts, f))) < kSameForm)) continue;
        const double amplitude = amplitude_of(parts, f);
        std::vector<double> by_block(study.blocks().count, 0.0);
        for (const Part& part : parts)
            for (std::size_t i = 0; i < part.rest.size(); ++i)
                by_block[study.blocks().of[part.observable][i]] +=
                    cost(part.rest[i] - amplitude * part.answers[f][i], part.freedom) -
                    cost(part.rest[i] - own_amplitude * part.answers[0][i], part.freedom);
        forms.push_back({kForms[f].words, gain_of(by_block)});
    }
    return forms;
}

FormVerdict form_verdict(const std::vector<RivalForm>& forms) {
    FormVerdict verdict;
    for (const RivalForm& one : forms) {
        Gain against = one.gain;
        against.sum = -against.sum;
        if (gains_enough(against, forms.size(), 1)) {
            if (against.sum <= verdict.left) continue;
            verdict.left = against.sum;
            verdict.better = one.form;
        } else if (!gains_enough(one.gain, forms.size(), 1)) {
            verdict.open.push_back(one.form);
        }
    }
    return verdict;
}

}  // namespace puckloop::gap
