#include "gap/diagnostics/heldout.h"

#include "base/random.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap {

namespace {

constexpr int kDraws = 1000;  // of the bootstrap over blocks

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double root_mean(const std::vector<double>& sums, double rows) {
    return std::sqrt(sum_of(sums) / std::max(rows, 1.0));
}

template <class Figures>
void compare(const std::vector<double>& before, const std::vector<double>& after, double rows,
             std::uint64_t seed, Figures& to) {
    to.before = root_mean(before, rows);
    to.after = root_mean(after, rows);
    const double all = sum_of(before);
    to.ratio = to.low = to.high = all > 0 ? std::sqrt(sum_of(after) / all) : 1.0;
    RandomStream random(seed, "gap/ratio");
    std::vector<double> ratios;
    for (int draw = 0; draw < kDraws; ++draw) {
        double b = 0, a = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const std::size_t k = random.below(before.size());
            b += before[k];
            a += after[k];
        }
        if (b > 0) ratios.push_back(std::sqrt(a / b));
    }
    if (ratios.empty()) return;
    std::ranges::sort(ratios);
    to.low = ratios[ratios.size() / 20];
    to.high = ratios[ratios.size() - 1 - ratios.size() / 20];
}

}  // namespace

void compare_errors(const std::vector<double>& before, const std::vector<double>& after, double rows,
                    std::uint64_t seed, HeldObservable& to) {
    compare(before, after, rows, seed, to);
}

HeldFigures held_figures(const Study& study, const Selection& selection, std::uint64_t seed) {
    const auto& observables = study.model().observables();
    const std::size_t units = study.blocks().count;
    const HeldOut none = study.hold_out(selection.none, kHeldOut),
                  chosen =
                      selection.chosen.effects.empty() ? none : study.hold_out(selection.chosen, kHeldOut);
    std::vector<std::vector<double>> before(observables.size() + 1, std::vector<double>(units, 0.0)),
        after = before;
    std::vector<double> counts(units, 0.0);
    for (std::size_t o = 0; o < observables.size(); ++o) {
        const double sd = observables[o].noise == NoiseKind::Event
                              ? 1.0
                              : std::exp(selection.chosen.fitted.state.noise[o].log_sd);
        for (std::size_t i = 0; i < observables[o].y.size(); ++i) {
            const std::uint32_t block = study.blocks().of[o][i];
            const double old_error = observables[o].y[i] - none.mean[o][i];
            const double new_error = observables[o].y[i] - chosen.mean[o][i];
            before[o][block] += old_error * old_error;
            after[o][block] += new_error * new_error;
            before.back()[block] += old_error * old_error / (sd * sd);
            after.back()[block] += new_error * new_error / (sd * sd);
            counts[block] += 1;
        }
    }
    HeldFigures figures;
    Held& held = figures.all;
    const double rows = sum_of(counts);
    compare(before.back(), after.back(), rows, seed, held);
    for (std::size_t o = 0; o < observables.size(); ++o) {
        HeldObservable one{observables[o].name, observables[o].unit};
        compare(before[o], after[o], static_cast<double>(observables[o].y.size()), seed, one);
        figures.observables.push_back(std::move(one));
        for (std::size_t i = 0; i < observables[o].y.size(); ++i) {
            held.score_before += none.score[o][i] / rows;
            held.score_after += chosen.score[o][i] / rows;
        }
    }
    const Gain gain = study.gain(none, chosen);
    held.score_low = (gain.sum - 1.645 * gain.sd) / rows;
    held.score_high = (gain.sum + 1.645 * gain.sd) / rows;
    held.runs = static_cast<int>(units);
    held.runs_better = static_cast<int>(std::lround(gain.share_better * static_cast<double>(units)));
    return figures;
}

}  // namespace puckloop::gap
