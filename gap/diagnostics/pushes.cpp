#include "gap/diagnostics/pushes.h"

#include "gap/diagnostics/taken_back.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit/filter.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/exchange.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kLeastPushes = 3.0;
constexpr double kIsPush = 0.5;

double sum_of_pushes(const std::vector<double>& all) {
    return std::accumulate(all.begin(), all.end(), 0.0);
}

/// What the rows of a model's pushed sums say.
struct Pushed {
    const Observable* base = nullptr;  ///< the first of them; null: there is none
    std::vector<double> chance;        ///< that a row is pushed, as fitted
    std::vector<double> pushed;        ///< how likely it was, one push shows in any of the sums
    std::vector<std::size_t> likely;   ///< those that were likelier pushed than not
    std::map<std::string, std::vector<double>> moved;  ///< how far, by each sum, its unit
};

Pushed pushed_rows(const Model& model, const State& state) {
    const Prediction prediction = model.predicted(state.values);
    Pushed rows;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        if (observable.noise != NoiseKind::Level || prediction[o].lapse.empty() || observable.fixed_sd > 0)
            continue;
        if (rows.base != nullptr && observable.row != rows.base->row) continue;
        Innovations innovations;
        filter(observable, prediction[o], state.noise[o], innovations);
        if (rows.base == nullptr) {
            rows.base = &observable;
            rows.pushed.assign(observable.y.size(), 0.0);
            rows.chance = prediction[o].lapse;
        }
        for (std::size_t i = 0; i < rows.pushed.size(); ++i)
            rows.pushed[i] = std::max(rows.pushed[i], innovations.pushed[i]);
        rows.moved[observable.name] = std::move(innovations.off);
    }
    for (std::size_t i = 0; i < rows.pushed.size(); ++i)
        if (rows.pushed[i] > kIsPush) rows.likely.push_back(i);
    return rows;
}

std::vector<Push> pushes_of(const Experiment& experiment, const Pushed& rows) {
    const auto moved = [&](const char* sum, std::size_t i) {
        const auto found = rows.moved.find(sum);
        return found == rows.moved.end() ? NAN : found->second[i];
    };
    const bool along = rows.moved.contains("along");
    std::vector<Push> pushes;
    auto run = static_cast<std::uint32_t>(-1);
    for (const std::size_t i : rows.likely) {
        const bool begins = std::exchange(run, rows.base->run[i]) != rows.base->run[i];
        const double x = moved(along ? "along" : "x_m", i), y = moved(along ? "across" : "y_m", i),
                     heading = experiment.runs[rows.base->run[i]].column("theta_rad")[rows.base->row[i]];
        // The sums stand along the robot's axes or the room's.
        const double turn = along ? heading : 0.0;
        pushes.push_back({begins, x * std::cos(turn) - y * std::sin(turn),
                          x * std::sin(turn) + y * std::cos(turn), heading, moved("heading", i)});
    }
    return pushes;
}

/// The most unlikely of several questions, its chance corrected for how many they are (Bonferroni).
class PushLook {
  public:
    void at(PushPattern one) {
        asked_ += 1;
        if (one.p_value < least_.p_value) least_ = std::move(one);
    }
    PushPattern least() const {
        PushPattern found = least_;
        found.p_value = std::min(asked_ * found.p_value, 1.0);
        return found;
    }

  private:
    double asked_ = 0.0;
    PushPattern least_;
};

/// Where many are, in cells of the covariates.
PushPattern by_place(const Experiment& experiment, const Pushed& rows, double hoped) {
    Series places;
    places.run = rows.base->run;
    places.row = rows.base->row;
    const double all = sum_of_pushes(rows.pushed);
    PushLook look;
    for (const stats::Component& component : free_form_cells(experiment, places, rows.base->starts)) {
        const auto there = stats::sums_of_cells(component, [&](std::size_t i) { return rows.pushed[i]; }),
                   share =
                       stats::sums_of_cells(component, [&](std::size_t i) { return rows.chance[i] / hoped; });
        for (std::size_t c = 0; c < there.size(); ++c)
            if (share[c] > 0)
                look.at({component.where[c], there[c], all, share[c] * all,
                         stats::binomial_tail(static_cast<unsigned>(std::ceil(all)), share[c],
                                              static_cast<unsigned>(std::floor(there[c])))});
    }
    return look.least();
}

/// Are some runs pushed more often than others? Chi squared, by drawn runs for as many pushes.
PushPattern by_run(const Pushed& rows, double hoped) {
    std::map<std::uint32_t, double> share;  // of all that are expected
    for (std::size_t i = 0; i < rows.pushed.size(); ++i)
        share[rows.base->run[i]] += rows.chance[i] / hoped;
    const auto all = static_cast<double>(rows.likely.size());
    const auto unevenness = [&](std::map<std::uint32_t, double> counts) {
        double sum = 0.0;
        for (const auto& [run, part] : share)
            if (part > 0) sum += std::pow(counts[run] - all * part, 2) / (all * part);
        return sum;
    };
    std::map<std::uint32_t, double> counts;
    for (const std::size_t i : rows.likely)
        counts[rows.base->run[i]] += 1;
    const auto drawn = [&](RandomStream& random) {
        std::map<std::uint32_t, double> other;
        for (std::size_t k = 0; k < rows.likely.size(); ++k) {
            double left = random.uniform();
            auto run = share.begin();
            while (std::next(run) != share.end() && (left -= run->second) >= 0)
                ++run;
            other[run->first] += 1;
        }
        return unevenness(std::move(other));
    };
    const auto most = std::ranges::max_element(counts, {}, [](const auto& one) { return one.second; });
    if (most == counts.end()) return {};
    return {"some runs", most->second, all, all * share[most->first],
            stats::null_p(unevenness(counts), all, drawn, {}, "pushes by run")};
}

}  // namespace

std::optional<PushPattern> push_pattern(const Experiment& experiment, const Model& model,
                                        const State& state) {
    const Pushed rows = pushed_rows(model, state);
    if (rows.base == nullptr) return std::nullopt;
    const double hoped = sum_of_pushes(rows.chance);
    if (!(hoped > 0)) return std::nullopt;
    double seen = 0.0;
    for (const std::size_t i : rows.likely)
        seen += rows.pushed[i];
    if (seen < thresholds::kPushesShown * hoped)
        return PushPattern{"rows that were as likely not pushed", hoped - seen, hoped, hoped - seen, 1.0};
    if (sum_of_pushes(rows.pushed) < kLeastPushes) return std::nullopt;
    PushLook look;
    look.at(by_place(experiment, rows, hoped));
    PushLook ways;
    for (PushPattern& one : push_directions(pushes_of(experiment, rows), seen))
        ways.at(std::move(one));
    look.at(ways.least());
    look.at(by_run(rows, hoped));
    const PushPattern found = look.least();
    if (found.p_value < thresholds::kPushesByChance) return found;
    // By Markov's inequality it refuses true pushes of such a law in one case of twenty at most.
    const double back = std::exp(-taken_back(experiment, model, state, rows.likely));
    if (!(back <= thresholds::kFalseAlarm)) return std::nullopt;
    return PushPattern{"back to where one before began", seen, seen, 0.0, back};
}

}  // namespace puckloop::gap
