#include "gap/residual_model/free_form_cells.h"

#include "gap/residuals/residual_structure.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

using stats::Component;
using stats::Covariate;
using stats::CovariateKind;

constexpr int kFine = 12, kMiddle = 8, kCoarse = 5;  // bins of a covariate alone, with its past, with another
constexpr int kFinest = 40;                          // of a covariate alone, for what ripples
constexpr int kPlaces = 60;                          // of a run
constexpr std::size_t kLately = 5;                   // rows
constexpr double kPlaceGrain = 0.05;                 // m, far over any tracker's noise
constexpr double kHeadingGrain = std::numbers::pi / 6;  // rad
constexpr double kStepsOfATurn = 1000;                  // of the motor, of one turn of the wheel

/// Bins that leave missing values out. A label's values are its bins.
Component cells_of(const std::string& name, const std::vector<double>& values, int bins, bool label,
                   const std::vector<std::string>& labels = {}) {
    Component c;
    c.name = name;
    c.ordered = !label;
    c.cell = stats::bins_of(values, c.cells, bins, label ? kFine : std::max(bins, kMiddle));
    c.at = stats::means_at(c.cell, c.cells, values);
    for (const double at : c.at) {
        const auto code = static_cast<std::size_t>(std::max(at, 0.0));
        c.where.push_back(label ? name + " " + (code < labels.size() ? labels[code] : stats::plain(at))
                                : name + " = " + stats::plain(at));
    }
    return c;
}

Component finer(Component c) {
    c.qualifier = fmt::format(" ({} bins)", c.cells);
    return c;
}

/// So few that each is a bin of its own.
bool few_values(std::vector<double> values) {
    std::ranges::sort(values);
    return std::unique(values.begin(), values.end()) - values.begin() <= kFine;
}

Component crossed(const Component& a, const Component& b) {
    Component c;
    c.name = a.name + " and " + b.name;
    c.pair = true;
    c.cells = a.cells * b.cells;
    for (const std::string& one : a.where)
        for (const std::string& other : b.where)
            c.where.push_back(one + ", " + other);
    for (std::size_t i = 0; i < a.cell.size(); ++i)
        c.cell.push_back(a.cell[i] < 0 || b.cell[i] < 0 ? -1 : a.cell[i] * b.cells + b.cell[i]);
    return c;
}

/// What a covariate was in the rows before, chain by chain.
struct Lately {
    std::vector<double> before, lowest, highest, since;
};

Lately lately(const std::vector<double>& x, const std::vector<double>& time,
              const std::vector<char>& starts) {
    Lately out;
    std::size_t begin = 0, changed = 0;  // rows; the same: nothing changed yet
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (starts[i] != 0) begin = changed = i;
        if (i > begin && x[i] != x[i - 1]) changed = i;
        out.before.push_back(i > begin ? x[i - 1] : NAN);
        double low = x[i], high = x[i];
        for (std::size_t k = i - std::min(kLately - 1, i - begin); k < i; ++k) {
            low = std::fmin(low, x[k]);
            high = std::fmax(high, x[k]);
        }
        out.lowest.push_back(low);
        out.highest.push_back(high);
        out.since.push_back(changed > begin ? time[i] - time[changed] : NAN);
    }
    return out;
}

/// The tracker's own errors must not choose the cell they fall into: a drive along y = 0 would seem to pull
/// away from its line on either side.
double whole(double value, double grain) {
    return grain * std::round(value / grain) + 0.0;  // no -0: its sign would be the error's
}

/// Tracked place and wheel phase of a drive: what no single column of the commands says.
void add_places(const Experiment& experiment, const Series& rows, std::vector<Covariate>& list) {
    if (experiment.kind != Kind::Motion) return;
    std::vector<Covariate> all;
    for (const char* name : {"position x", "position y", "distance from the origin",
                             "heading relative to the direction away from the origin",
                             "phase of the left wheel", "phase of the right wheel"})
        all.push_back({name, CovariateKind::Number, {}, {}});
    for (std::size_t i = 0; i < rows.run.size(); ++i) {
        const Run& run = experiment.runs[rows.run[i]];
        const auto value = [&](const char* name) {
            const auto& column = run.column(name);
            return column.empty() ? NAN : column[rows.row[i]];
        };
        const double x = whole(value("x_m"), kPlaceGrain), y = whole(value("y_m"), kPlaceGrain);
        const double outward = std::remainder(value("theta_rad") - std::atan2(y, x), 2 * std::numbers::pi);
        const double values[] = {x,
                                 y,
                                 whole(std::hypot(x, y), kPlaceGrain),
                                 whole(outward, kHeadingGrain),
                                 std::remainder(value("steps_left"), kStepsOfATurn),
                                 std::remainder(value("steps_right"), kStepsOfATurn)};
        for (std::size_t k = 0; k < all.size(); ++k)
            all[k].value.push_back(values[k]);
    }
    for (Covariate& one : all)
        if (stats::varies(one.value)) list.push_back(std::move(one));
}

}  // namespace

std::vector<Component> free_form_cells(const Experiment& experiment, const Series& rows,
                                       const std::vector<char>& starts) {
    std::vector<Covariate> covariates = covariates_of(experiment, rows);
    add_places(experiment, rows, covariates);
    std::vector<Component> all, coarse;
    for (const Covariate& c : covariates) {
        const bool label = c.kind == CovariateKind::Label;
        all.push_back(cells_of(c.name, c.value, kFine, label, c.labels));
        if (!label && !few_values(c.value)) all.push_back(finer(cells_of(c.name, c.value, kFinest, false)));
        if (c.name != "order" && c.name != "time")
            coarse.push_back(cells_of(c.name, c.value, kCoarse, label, c.labels));
    }
    std::vector<double> place;
    for (std::size_t i = 0; i < rows.run.size(); ++i)
        place.push_back(static_cast<double>(rows.row[i]) /
                        static_cast<double>(experiment.runs[rows.run[i]].rows));
    all.push_back(cells_of("position in the run", place, kPlaces, false));
    coarse.push_back(cells_of("position in the run", place, kMiddle, false));
    const std::size_t single = coarse.size();
    for (std::size_t a = 0; a < single; ++a)
        for (std::size_t b = a + 1; b < single; ++b)
            all.push_back(crossed(coarse[a], coarse[b]));
    const std::vector<double> time = times_of(experiment, rows);
    for (const Covariate& c : covariates) {
        if (c.kind == CovariateKind::Label || c.name == "order" || c.name == "time") continue;
        const Lately past = lately(c.value, time, starts);
        const Component now = cells_of(c.name, c.value, kMiddle, false);
        const auto add = [&](const std::string& name, const std::vector<double>& values) {
            if (!stats::varies(values)) return;
            all.push_back(cells_of(name, values, kFine, false));
            all.push_back(crossed(now, cells_of(name, values, kMiddle, false)));
        };
        const std::string recent = fmt::format(" of the last {} rows", kLately);
        add(c.name + " in the previous row", past.before);
        add("lowest " + c.name + recent, past.lowest);
        add("highest " + c.name + recent, past.highest);
        if (c.kind == CovariateKind::Signed) add("time since " + c.name + " changed", past.since);
    }
    std::erase_if(all, [](const Component& c) { return c.cells < 2; });
    return all;
}

}  // namespace puckloop::gap
