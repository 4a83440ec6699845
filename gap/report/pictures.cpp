#include "gap/report/pictures.h"

#include "base/pages/chart.h"
#include "gap/residuals/main_covariates.h"
#include "gap/residuals/residual_structure.h"
#include "gap/stats/bootstrap.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace puckloop::gap::report {

namespace {

constexpr double kWidth = 336, kHeight = 250;  // half an A4 line at 96 a inch
constexpr int kBins = 16;
constexpr double kCoverage = 0.9;

using stats::Covariate;

/// How the simulator is drawn, as it is and with the causes.
struct Shown {
    Stage stage;
    const char *colour, *name;
    bool dashed;
};
constexpr Shown kShown[] = {{Stage::Before, kBefore, "before", true}, {Stage::After, kAfter, "after", false}};

std::string left_over_label(const Series& series) {
    return with_unit(fmt::format("{}, measured − simulated", series.observable), series.unit);
}

stats::Series by_run(const Series& series, std::vector<double> value) {
    return {std::move(value), {series.run.begin(), series.run.end()}};
}

Picture measured_and_simulated(const Series& series, const Covariate& c) {
    Chart chart("Measured and simulated", covariate_label(c.name), with_unit(series.observable, series.unit));
    chart.clip(0.002, 0.998);
    chart.points(c.value, series.measured, kMeasured, "measured");
    for (const auto& [stage, colour, name, dashed] : kShown) {
        const stats::Band means =
            stats::bootstrap_band(by_run(series, simulated(series, stage)), c.value, kBins, kCoverage, 1);
        chart.line(means.x, means.y, colour, name, dashed);
    }
    return {chart.svg(kWidth, kHeight),
            fmt::format("{}: readings, and the simulator's mean over them.", series.observable)};
}

/// Groups side by side instead of a course: places 0, 1, ... for the values that occur.
std::vector<double> as_places(const Covariate& c, std::vector<std::string>& names) {
    std::map<double, double> place;
    for (const double v : c.value)
        if (std::isfinite(v)) place.emplace(v, 0);
    for (auto& [value, at] : place) {
        at = static_cast<double>(names.size());
        const auto index = static_cast<std::size_t>(std::max(value, 0.0));
        names.push_back(index < c.labels.size() ? c.labels[index] : fmt::format("{}", value));
    }
    std::vector<double> places;
    for (const double v : c.value)
        places.push_back(std::isfinite(v) ? place[v] : NAN);
    return places;
}

Picture residuals(const Series& series, const Covariate& c, const char* title, std::uint64_t seed) {
    Chart chart(title, covariate_label(c.name), left_over_label(series));
    chart.level(0);
    const bool groups = c.kind == stats::CovariateKind::Label;
    std::vector<std::string> names;
    const std::vector<double> x = groups ? as_places(c, names) : c.value;
    for (const Shown& shown : kShown) {
        const stats::Band band =
            stats::bootstrap_band(by_run(series, left_over(series, shown.stage)), x, kBins, kCoverage, seed);
        for (std::size_t i = 0; groups && i < band.x.size(); ++i)
            chart.interval(band.x[i] + (shown.dashed ? -0.1 : 0.1), band.y[i], band.low[i], band.high[i],
                           shown.colour);
        if (groups) continue;
        chart.band(band.x, band.low, band.high, shown.colour);
        chart.line(band.x, band.y, shown.colour, shown.name, shown.dashed);
    }
    chart.categories(names);
    return {chart.svg(kWidth, kHeight),
            fmt::format(
                "{} left over against {} (blue before, orange after); bands: 90 % by bootstrap over runs.",
                series.observable, c.name)};
}

std::vector<double> of_run(const Series& series, const std::vector<double>& values, std::uint32_t run) {
    std::vector<double> result;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (series.run[i] == run) result.push_back(values[i]);
    return result;
}

Picture by_run_picture(const Experiment& experiment, const Series& series) {
    Chart chart("Left over, run by run", "run, in order of the file", left_over_label(series));
    chart.level(0);
    std::vector<std::string> names;
    const bool few = experiment.runs.size() <= 6;
    for (std::size_t r = 0; r < experiment.runs.size(); ++r)
        names.push_back(few || r % ((experiment.runs.size() + 11) / 12) == 0 ? std::to_string(r + 1) : "");
    for (const Shown& shown : kShown) {
        const std::vector<double> rest = left_over(series, shown.stage);
        for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
            const std::vector<double> inside = of_run(series, rest, static_cast<std::uint32_t>(r));
            const double middle = stats::median(inside);
            if (!std::isfinite(middle)) continue;
            chart.interval(static_cast<double>(r) + (shown.dashed ? -0.12 : 0.12), middle,
                           stats::quantile(inside, 0.05), stats::quantile(inside, 0.95), shown.colour);
        }
    }
    chart.categories(names);
    return {chart.svg(kWidth, kHeight),
            fmt::format("Median and 5–95 % range of {} left over in each run (blue before, orange after).",
                        series.observable)};
}

/// The covariate with the clearest structure before, by trend and shape; nullptr if none is clear.
const Covariate* clearest(const Series& series, const std::vector<Covariate>& all, const std::string& but,
                          std::uint64_t seed) {
    const stats::Series residual = by_run(series, residual_of(series, Stage::Before));
    const stats::TestOptions options{.seed = seed, .permutations = 199};
    const Covariate* best = nullptr;
    double least = 0.01;
    for (const Covariate& c : all) {
        if (c.name == but || c.name == "order") continue;
        const std::vector<int> labels(c.value.begin(), c.value.end());
        const double p = c.kind == stats::CovariateKind::Label
                             ? stats::group_test(residual, labels, c.name, c.labels, options).p
                             : stats::shape_test(residual, c.value, c.name, options).p;
        if (p < least) least = p, best = &c;
    }
    return best;
}

/// Dead reckoning from along, across and heading at each row of one run.
struct Track {
    std::vector<double> x, y;
};

Track integrated(const std::vector<double>& along, const std::vector<double>& across,
                 const std::vector<double>& heading, double x, double y, double first_heading) {
    Track track{{x}, {y}};
    for (std::size_t i = 1; i < along.size(); ++i) {
        const double middle = first_heading + (heading[i] + heading[i - 1]) / 2 - heading[0];
        const double a = along[i] - along[i - 1], b = across[i] - across[i - 1];
        if (std::isfinite(a + b + middle)) {
            x += a * std::cos(middle) - b * std::sin(middle);
            y += a * std::sin(middle) + b * std::cos(middle);
        }
        track.x.push_back(x);
        track.y.push_back(y);
    }
    return track;
}

const Series* series_named(const Verdict& verdict, std::string_view name) {
    for (const Series& s : verdict.series)
        if (s.observable == name) return &s;
    return nullptr;
}

}  // namespace

std::vector<Picture> pictures_of(const Experiment& experiment, const Series& series, std::uint64_t seed) {
    const std::vector<Covariate> all = covariates_of(experiment, series);
    const Covariate main = main_covariates(experiment, series.observable, all, series.row).front();
    std::vector<Picture> pictures;
    const bool sums =
        experiment.kind == Kind::Motion || experiment.kind == Kind::Timing;  // say little as they are
    if (!sums) pictures.push_back(measured_and_simulated(series, main));
    pictures.push_back(residuals(series, main, "Left over, before and after", seed));
    if (experiment.runs.size() > 1) pictures.push_back(by_run_picture(experiment, series));
    if (const Covariate* other = clearest(series, all, main.name, seed))
        pictures.push_back(residuals(series, *other, "Where structure was clearest besides", seed));
    return pictures;
}

std::vector<Picture> path_pictures(const Experiment& experiment, const Verdict& verdict) {
    const bool room = series_named(verdict, "along") == nullptr;  // places, not sums
    const Series* along = series_named(verdict, room ? "x_m" : "along");
    const Series* across = series_named(verdict, room ? "y_m" : "across");
    const Series* heading = series_named(verdict, "heading");
    std::vector<Picture> pictures;
    if (along == nullptr || across == nullptr || heading == nullptr) return pictures;
    constexpr std::size_t kMost = 4;
    const std::size_t stride = std::max<std::size_t>((experiment.runs.size() + kMost - 1) / kMost, 1);
    for (std::size_t r = 0; r < experiment.runs.size(); r += stride) {
        const Run& run = experiment.runs[r];
        const auto number = static_cast<std::uint32_t>(r);
        const auto measured = of_run(*along, along->measured, number);
        if (measured.size() < 2) continue;
        const auto row = of_run(*along, {along->row.begin(), along->row.end()}, number);
        const auto first = static_cast<std::size_t>(row.front());
        Chart chart(fmt::format("Path of {}", run.name), "x (m)", "y (m)");
        chart.equal_axes();
        std::vector<double> x, y;
        for (const double at : row) {
            x.push_back(run.column("x_m")[static_cast<std::size_t>(at)]);
            y.push_back(run.column("y_m")[static_cast<std::size_t>(at)]);
        }
        chart.line(x, y, kMeasured, "measured");
        for (const auto& [stage, colour, name, dashed] : kShown) {
            const auto a = of_run(*along, simulated(*along, stage), number),
                       b = of_run(*across, simulated(*across, stage), number);
            Track track{a, b};  // from where the run began
            if (room) {
                std::ranges::for_each(track.x, [&](double& one) { one += x.front(); });
                std::ranges::for_each(track.y, [&](double& one) { one += y.front(); });
            } else {
                track = integrated(a, b, of_run(*heading, simulated(*heading, stage), number), x.front(),
                                   y.front(), run.column("theta_rad")[first]);
            }
            chart.line(track.x, track.y, colour, name, dashed);
        }
        pictures.push_back({chart.svg(kWidth, kWidth),
                            "Tracked path and the simulator's dead reckoning from its first pose."});
    }
    return pictures;
}

Picture gain_picture(const Verdict& verdict) {
    Chart chart("Error on held-out runs, after over before", "", "ratio (1 = no gain)");
    std::vector<std::string> names{"all"};
    chart.level(1);
    chart.interval(0, verdict.heldout.ratio, verdict.heldout.low, verdict.heldout.high, kAfter);
    for (const HeldObservable& o : verdict.observables) {
        chart.interval(static_cast<double>(names.size()), o.ratio, o.low, o.high, kBefore);
        names.push_back(o.name);
    }
    chart.categories(names);
    return {chart.svg(kWidth, kHeight),
            "Ratio of rms errors on runs that were not fitted, with 90 % intervals over runs."};
}

}  // namespace puckloop::gap::report
