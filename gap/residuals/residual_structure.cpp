#include "gap/residuals/residual_structure.h"

#include "gap/kinds/columns.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <set>

namespace puckloop::gap {

namespace {

using stats::Covariate;
using stats::CovariateKind;

/// What names a thing, not a size.
const std::set<std::string_view> kLabels{"sensor", "object",  "emitter", "receiver",
                                         "mic",    "session", "unit",    "occluded"};
const std::set<std::string_view> kSigned{"velocity", "speed",    "motor_speed", "acceleration",
                                         "lateral",  "cmd_left", "cmd_right"};
/// Cumulative counts say nothing by themselves; what follows from them does. The clocks are time.
const std::set<std::string_view> kNotByThemselves{"steps_left", "steps_right", "t_host_s",
                                                  "t_robot_s",  "x_m",         "y_m"};
/// Along and across are turned by the measured heading, whose noise is then in both residual and covariate:
/// a sector is all that may be asked about. A robot near the edge of two stays in the one it is in, else its
/// heading's noise would sort its rows.
constexpr std::string_view kMeasuredHeading = "theta_rad";
constexpr double kSector = std::numbers::pi / 6, kLeavesSector = 0.75 * kSector;

std::vector<double> in_sectors(std::vector<double> heading, const std::vector<std::uint32_t>& run) {
    double sector = NAN;
    for (std::size_t i = 0; i < heading.size(); ++i) {
        if (i == 0 || run[i] != run[i - 1]) sector = NAN;
        const double value = std::remainder(heading[i], 2 * std::numbers::pi);
        if (std::isnan(value)) continue;
        const bool stays = std::abs(std::remainder(value - sector, 2 * std::numbers::pi)) < kLeavesSector;
        if (!stays) sector = kSector * std::round(value / kSector) + 0.0;
        if (sector < -std::numbers::pi + kSector / 2) sector += 2 * std::numbers::pi;
        heading[i] = sector;
    }
    return heading;
}

/// A value in each row of the series, from what `column(run)` gives for each run.
template <class Column>
std::vector<double> gathered(const Experiment& experiment, const Series& series, const Column& column) {
    std::vector<const std::vector<double>*> by_run;
    for (std::size_t run = 0; run < experiment.runs.size(); ++run)
        by_run.push_back(&column(run));
    std::vector<double> values(series.run.size(), NAN);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::vector<double>& own = *by_run[series.run[i]];
        if (series.row[i] < own.size()) values[i] = own[series.row[i]];
    }
    return values;
}

std::vector<double> of_column(const Experiment& experiment, const Series& series, std::string_view name) {
    return gathered(
        experiment,
        series, [&](std::size_t run) -> const auto& { return experiment.runs[run].column(name); });
}

void add_conditions(const Experiment& experiment, const Series& series, std::vector<Covariate>& list) {
    std::set<std::string> names;
    for (const Run& run : experiment.runs)
        for (const auto& [name, text] : run.conditions)
            if (name != "session" && name != "unit") names.insert(name);
    for (const std::string& name : names) {
        Covariate c{name, CovariateKind::Label, {}, {}};
        std::map<std::string, int> codes;
        for (const Run& run : experiment.runs)
            if (codes.emplace(run.condition(name), static_cast<int>(codes.size())).second)
                c.labels.push_back(run.condition(name));
        for (const auto run : series.run)
            c.value.push_back(codes.at(experiment.runs[run].condition(name)));
        // A condition that every run has for itself is the run's name, nothing to compare.
        if (codes.size() < experiment.runs.size()) list.push_back(std::move(c));
    }
}

/// What the wheels' counters say of the motion at each row of a run, in steps and seconds.
struct Derived {
    std::vector<double> speed, turn_rate, acceleration, travelled;
};

Derived derived_of(const Run& run) {
    Derived d;
    const auto& left = run.column("steps_left");
    const auto& right = run.column("steps_right");
    const auto& t = run.column("t_s");
    if (left.empty() || right.empty() || t.empty()) return d;
    double travelled = 0, last = 0;
    for (std::size_t i = 0; i < run.rows; ++i) {
        const std::size_t from = i == 0 ? 0 : i - 1;
        const double dt = i == 0 ? NAN : t[i] - t[from];
        const double l = (left[i] - left[from]) / dt, r = (right[i] - right[from]) / dt;
        const double speed = (l + r) / 2;
        if (i > 0 && std::isfinite(speed)) travelled += std::fabs(speed) * dt;
        d.speed.push_back(speed);
        d.turn_rate.push_back(r - l);
        d.acceleration.push_back(i > 1 ? (speed - last) / dt : NAN);
        d.travelled.push_back(travelled);
        last = speed;
    }
    return d;
}

void add_derived(const Experiment& experiment, const Series& series, std::vector<Covariate>& list) {
    if (experiment.kind != Kind::Motion) return;
    std::vector<Derived> derived;
    for (const Run& run : experiment.runs)
        derived.push_back(derived_of(run));
    const auto add = [&](const char* name, CovariateKind kind, std::vector<double> Derived::*member) {
        const auto of_run = [&](std::size_t run) -> const auto& {
            return derived[run].*member;
        };
        Covariate c{name, kind, gathered(experiment, series, of_run), {}};
        if (stats::varies(c.value)) list.push_back(std::move(c));
    };
    add("wheel speed", CovariateKind::Signed, &Derived::speed);
    add("turn rate", CovariateKind::Signed, &Derived::turn_rate);
    add("acceleration", CovariateKind::Signed, &Derived::acceleration);
    add("distance so far", CovariateKind::Number, &Derived::travelled);
}

}  // namespace

std::string plain_name(std::string name) {
    if (name == "t_s") return "time";
    for (const std::string_view unit : {"_m", "_rad", "_s", "_c", "_v", "_kg"})
        if (name.size() > unit.size() + 1 && name.ends_with(unit)) {
            name.resize(name.size() - unit.size());
            break;
        }
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
}

const std::vector<double>& simulated(const Series& series, Stage stage) {
    return stage == Stage::Before ? series.before : series.after;
}

std::vector<double> left_over(const Series& series, Stage stage) {
    const std::vector<double>& shown = simulated(series, stage);
    std::vector<double> rest(series.measured.size(), NAN);
    for (std::size_t i = 0; i < rest.size() && i < shown.size(); ++i)
        rest[i] = series.measured[i] - shown[i];
    return rest;
}

std::vector<double> residual_of(const Series& series, Stage stage) {
    const auto& innovation = stage == Stage::Before ? series.innovation_before : series.innovation_after;
    return innovation.size() == series.measured.size() ? innovation : left_over(series, stage);
}

std::vector<Covariate> covariates_of(const Experiment& experiment, const Series& series) {
    std::vector<Covariate> list;
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        const std::string_view name = info.name;
        if (info.role == Role::Observable || kNotByThemselves.contains(name) || !experiment.has(name))
            continue;
        const CovariateKind kind = kLabels.contains(name) || info.index ? CovariateKind::Label
                                   : kSigned.contains(name)             ? CovariateKind::Signed
                                                                        : CovariateKind::Number;
        Covariate c{plain_name(info.name), kind, of_column(experiment, series, name), {}};
        if (experiment.kind == Kind::Motion && name == kMeasuredHeading)
            c.value = in_sectors(c.value, series.run);
        if (stats::varies(c.value)) list.push_back(std::move(c));
    }
    add_conditions(experiment, series, list);
    add_derived(experiment, series, list);
    return list;
}

std::vector<double> times_of(const Experiment& experiment, const Series& series) {
    for (const char* clock : {"t_s", "t_host_s", "t_robot_s"})
        if (experiment.has(clock)) return of_column(experiment, series, clock);
    return {series.row.begin(), series.row.end()};
}

std::vector<stats::Finding> residual_structure(const Experiment& experiment, const Series& series,
                                               Stage stage, const stats::TestOptions& options) {
    stats::StructureInput input;
    input.residual.value = residual_of(series, stage);
    input.residual.run.assign(series.run.begin(), series.run.end());
    input.residual.events = series.events;
    input.time = times_of(experiment, series);
    input.level = simulated(series, stage);
    // Of a reading at an end of the instrument only the middle of what it may be is known: it scatters less.
    if (const auto ends = experiment.instruments.find(series.observable);
        ends != experiment.instruments.end())
        for (std::size_t i = 0; i < input.level.size(); ++i)
            if (ends->second.at_end(series.measured[i])) input.level[i] = NAN;
    input.raw = series.measured;
    input.covariates = covariates_of(experiment, series);
    return stats::structure_table(input, options);
}

}  // namespace puckloop::gap
