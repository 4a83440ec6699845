#include "gap/extension/subjects.h"

#include "gap/kinds/columns.h"
#include "gap/kinds/description.h"
#include "physics/description/extension.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace puckloop::gap {

namespace {

constexpr double kMostDirections = 0.9;  // of a turn: angles that go further round are periodic

/// A column of the experiment as the world calls it.
struct ColumnName {
    const char *column, *known;
    bool factor = false;
};

constexpr ColumnName kDrive[] = {{"t_s", "time"}, {"theta_rad", "heading"}, {"battery_v", "battery"}};
constexpr ColumnName kProximity[] = {
    {"distance_m", "distance"}, {"angle_rad", "angle"}, {"t_s", "time"},
    {"battery_v", "battery"},   {"ambient", "ambient"}, {"motor_speed", "motor_speed"}};
constexpr ColumnName kGround[] = {{"grey", "grey"},         {"t_s", "time"},
                                  {"battery_v", "battery"}, {"ambient", "ambient"},
                                  {"speed", "speed"},       {"motor_speed", "motor_speed"},
                                  {"pitch_rad", "pitch"},   {"acceleration", "acceleration"}};
constexpr ColumnName kMicrophone[] = {
    {"t_s", "time"}, {"battery_v", "battery"}, {"motor_speed", "motor_speed"}};
constexpr ColumnName kAccelerometer[] = {
    {"pitch_rad", "pitch"},   {"roll_rad", "roll"},           {"t_s", "time"},
    {"battery_v", "battery"}, {"motor_speed", "motor_speed"}, {"speed", "speed"}};
// What the world has no place for is learnt all the same: what it gains is of interest.
constexpr ColumnName kRab[] = {{"distance_m", "distance"},
                               {"true_bearing_rad", "true_bearing"},
                               {"sender_bearing_rad", "sender_bearing"},
                               {"t_s", "time"}};
constexpr ColumnName kTiming[] = {
    {"t_s", "time"}, {"bytes", "bytes"}, {"i2c_reads", "i2c_reads"}, {"load", "load"}};

std::span<const ColumnName> columns_known(const Kind& kind) {
    switch (kind) {
    case Kind::Motion:
        return kDrive;
    case Kind::Proximity:
        return kProximity;
    case Kind::Ground:
        return kGround;
    case Kind::Microphone:
        return kMicrophone;
    case Kind::Accelerometer:
        return kAccelerometer;
    case Kind::Rab:
        return kRab;
    default:
        return kTiming;
    }
}

std::string sensor_column(const Kind& kind) {
    if (const Description* own = kind.description()) return own->chain;
    return kind == Kind::Microphone ? "mic" : kind == Kind::Rab ? "receiver" : "sensor";
}

std::string quantity_of(const Kind& kind, const std::string& observable) {
    switch (kind) {
    case Kind::Motion:
        return observable == "along"    ? "motion.forward"
               : observable == "across" ? "motion.left"
                                        : "motion.turn";
    case Kind::Proximity:
        return "proximity.reading";
    case Kind::Ground:
        return "ground.reading";
    case Kind::Microphone:
        return "microphone.level";
    case Kind::Accelerometer:
        return "accelerometer." + observable.substr(1);
    default:
        return {};
    }
}

std::string unit_of_known(const std::string& name) {
    const auto known = physics::known_named(name);
    if (known) return physics::extension_covariates()[static_cast<std::size_t>(*known)].unit;
    return name.ends_with("bearing") ? "rad" : "1";
}

std::vector<double> of_column(const Experiment& experiment, const Observable& observable, const char* name) {
    std::vector<double> values(observable.y.size(), NAN);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto& column = experiment.runs[observable.run[i]].column(name);
        if (observable.row[i] < column.size()) values[i] = column[observable.row[i]];
    }
    return values;
}

/// What is known of each row, as the world calls it; of a described kind as its user does.
std::vector<WorldCovariate> known_covariates(const Experiment& experiment, const Observable& observable) {
    std::vector<WorldCovariate> all;
    if (experiment.kind == Kind::Described) {
        for (const ColumnInfo& column : columns_of(experiment.kind))
            if (column.role != Role::Observable && !column.index)
                all.push_back({column.name, column.unit, of_column(experiment, observable, column.name)});
        return all;
    }
    for (const ColumnName& one : columns_known(experiment.kind))
        all.push_back(
            {one.known, unit_of_known(one.known), of_column(experiment, observable, one.column), one.factor});
    return all;
}

/// A drive's moments, with what the wheels say of each.
void add_wheels(const std::vector<WheelMoment>& moments, std::size_t rows, Subject& subject) {
    WorldCovariate speed{"speed", "m/s", {}, true}, turn_rate{"turn_rate", "rad/s", {}, true},
        travelled{"travelled", "m", {}};
    subject.moments.assign(rows + 1, 0);
    for (const WheelMoment& moment : moments) {
        ++subject.moments[moment.row + 1];
        subject.weight.push_back(moment.seconds);
        speed.value.push_back(moment.speed);
        turn_rate.value.push_back(moment.turn_rate);
        travelled.value.push_back(moment.travelled);
    }
    std::partial_sum(subject.moments.begin(), subject.moments.end(), subject.moments.begin());
    for (WorldCovariate* one : {&speed, &turn_rate, &travelled})
        subject.covariates.push_back(std::move(*one));
}

/// From rows to moments: between two rows a straight line, of an angle the shorter way round.
void look_between_rows(const std::vector<WheelMoment>& moments, WorldCovariate& one) {
    std::vector<double> between;
    for (const WheelMoment& moment : moments) {
        const double before = one.value[moment.row - 1], change = one.value[moment.row] - before;
        between.push_back(before +
                          moment.share *
                              (one.unit == "rad" ? std::remainder(change, 2 * std::numbers::pi) : change));
    }
    one.value = std::move(between);
}

void wrap(WorldCovariate& one) {
    if (one.unit != "rad" || one.name == "angle" || one.name == "pitch" || one.name == "roll") return;
    for (double& value : one.value)
        value = std::remainder(value, 2 * std::numbers::pi);
    const auto known = [](double value) { return std::isfinite(value); };
    if (std::ranges::none_of(one.value, known)) return;
    double low = INFINITY, high = -INFINITY;
    for (const double value : one.value)
        if (known(value)) low = std::min(low, value), high = std::max(high, value);
    one.periodic = high - low > kMostDirections * 2 * std::numbers::pi;
}

/// A covariate that is not known in every row is none: the term would act in some rows only.
bool usable(const WorldCovariate& one) {
    return !one.value.empty() &&
           std::ranges::all_of(one.value, [](double value) { return std::isfinite(value); }) &&
           std::ranges::any_of(one.value, [&](double value) { return value != one.value.front(); });
}

}  // namespace

std::vector<Subject> subjects_of(const Experiment& experiment, const Model& model,
                                 const std::vector<double>& values, const Prediction& prediction) {
    std::vector<Subject> subjects;
    const auto& observables = model.observables();
    const bool drives = experiment.kind == Kind::Motion;
    const auto wheels = drives ? model.wheel_moments(values) : std::vector<WheelMoment>{};
    for (std::size_t o = 0; o < observables.size(); ++o) {
        const Observable& observable = observables[o];
        if (observable.noise == NoiseKind::Event || observable.fixed_sd > 0 || observable.y.empty()) continue;
        Subject subject;
        subject.observable = o;
        subject.quantity = quantity_of(experiment.kind, observable.name);
        if (const auto extended = physics::extended_named(subject.quantity))
            subject.quantity_unit = physics::extended_quantities()[static_cast<std::size_t>(*extended)].unit;
        else
            subject.quantity_unit = observable.unit;
        subject.sums = adds_up(observable);
        subject.run = observable.run;
        subject.starts = observable.starts;
        for (std::size_t i = 0; i < observable.y.size(); ++i)
            subject.error.push_back(observable.instrument.at_end(observable.y[i])
                                        ? NAN
                                        : observable.y[i] - shown(prediction[o], i));
        if (drives) {
            add_wheels(wheels, observable.y.size(), subject);
        } else {
            subject.moments.resize(observable.y.size() + 1);
            std::iota(subject.moments.begin(), subject.moments.end(), 0U);
            subject.weight.assign(observable.y.size(), 1.0);
        }
        for (WorldCovariate& covariate : known_covariates(experiment, observable)) {
            if (experiment.kind == Kind::Proximity && covariate.name == "angle")  // a run's has no side
                std::ranges::transform(covariate.value, covariate.value.begin(),
                                       [](double angle) { return std::abs(angle); });
            if (drives) look_between_rows(wheels, covariate);
            wrap(covariate);
            if (usable(covariate)) subject.covariates.push_back(std::move(covariate));
        }
        if (!subject.sums) subject.covariates.push_back({"level", observable.unit, prediction[o].mean, true});
        std::erase_if(subject.covariates, [](const WorldCovariate& one) { return !usable(one); });
        for (const double one : of_column(experiment, observable, sensor_column(experiment.kind).c_str()))
            subject.sensor.push_back(std::isfinite(one) ? static_cast<int>(std::lround(one)) : 0);
        subject.sensors = *std::ranges::max_element(subject.sensor) + 1;
        subjects.push_back(std::move(subject));
    }
    return subjects;
}

}  // namespace puckloop::gap
