#include "gap/identify/counts.h"

#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostDriveRows = 6000;  // whole runs up to so many rows decide: more say the same again
constexpr double kMeanErrors = 0.5, kDifferenceErrors = 2.0;  // variances of one wheel's counter

/// How many rows, runs from the first one on, are looked at.
std::size_t looked_at(const Observable& heading) {
    std::size_t end = heading.y.size();
    for (std::size_t i = kMostDriveRows; i < heading.y.size(); ++i)
        if (heading.starts[i] != 0) {
            end = i;
            break;
        }
    return end;
}

void fill_channel(DriveChannel& channel, const std::vector<double>& seen, const std::vector<double>& without,
                  const std::vector<double>& with, const std::vector<char>& starts) {
    channel.seen.assign(seen.begin(), seen.begin() + static_cast<std::ptrdiff_t>(starts.size()));
    for (std::size_t i = 0; i < starts.size(); ++i) {
        channel.without.push_back(starts[i] != 0 ? 0.0 : without[i] - without[i - 1]);
        channel.with.push_back(starts[i] != 0 ? 0.0 : with[i] - with[i - 1]);
    }
}

/// Of what is counted in a row: what reaches the pose, by a metre. `turns`: by a metre that the wheels part.
double gain_of_row(const Model& model, const std::vector<double>& values, bool turns, double way,
                   double apart) {
    const auto value = [&](const char* name) { return values[model.find(name).value()]; };
    const double scale = 1 + value("wheel_scale");
    if (!turns) return scale;
    const double twist = std::abs(apart) / 2, all = std::abs(way) + twist;
    const double scrub = all > 0 ? value("robot.turn_scrub") * twist / all : 0.0;
    return scale / (value("robot.axle_length") * (1 + scrub));
}

constexpr DriveNoise kSlipOnly{.counters = false, .slip = true},
    kCountersOnly{.counters = true, .slip = false};

double share_tolerance(const DriveFit& fit) {
    return std::max(thresholds::kShareLeft, 2 * fit.share_sd);
}

/// Does a drive show a cause, and by the number that was fitted? `needed`: nats.
struct Shown {
    double gained;
    bool same;
    bool enough(double needed) const { return gained >= needed && same; }
};
Shown shown_by(const CountedDrive& drive, const DriveNoise& noise, const DriveFit& free) {
    // One number more was fitted (Akaike 1974); the sets it was chosen from are the criterion's.
    return {fit_drive(drive, noise, 0.0).cost - free.cost - 1,
            std::abs(free.share - 1) <= share_tolerance(free)};
}

/// Why a drive does not show a cause beside counters that err, though it does beside counters that do not.
std::string hidden_by_counters(const CountedDrive& drive, double needed) {
    const DriveFit free = fit_drive(drive, {});
    const Shown beside = shown_by(drive, {}, free);
    if (beside.enough(needed)) return "";
    const DriveFit sure = fit_drive(drive, kSlipOnly);
    const bool err = sure.cost - free.cost > kClearGain;
    if (!err && fit_drive(drive, kCountersOnly).cost - free.cost > kClearGain)
        return "";  // wheels slip, and counters show no errors
    // What these two sums do not show without errors either is seen elsewhere, across the heading.
    if (!shown_by(drive, kSlipOnly, sure).enough(needed)) return "";
    const std::string errs =
        err ? fmt::format("counters that err by {:.2g} mm a row", free.counter_sd * 1e3)
            : "counters that err, or wheels that slip (these drives cannot part the two),";
    if (beside.gained < needed)
        return fmt::format("it gains no more than chance beside {}: not identifiable by these drives", errs);
    return fmt::format("beside {} it would be {:.0f} +- {:.0f} % of what fits best without: not "
                       "identifiable by these drives",
                       errs, 100 * free.share, 100 * free.share_sd);
}

}  // namespace

CountedDrive drive_of(const Study& study, const Fit& fit, std::span<const std::size_t> effects) {
    const auto model = make_model(study.experiment(), MotionView::Robot);
    const std::vector<double>& with = fit.fitted.state.values;
    State none = fit.fitted.state;
    for (const std::size_t effect : effects)
        none = study.without(effect, std::move(none));
    const WheelRows wheels = model->wheels(with);
    CountedDrive drive;
    const auto& observables = model->observables();
    if (wheels.left.empty() || wheels.left.size() != observables[2].y.size()) return drive;
    const Prediction having = model->predicted(with), lacking = model->predicted(none.values);
    const std::size_t rows = looked_at(observables[2]);
    drive.quantum = wheels.quantum;
    drive.starts.assign(observables[2].starts.begin(),
                        observables[2].starts.begin() + static_cast<std::ptrdiff_t>(rows));
    drive.starts.front() = 1;
    for (const bool turns : {false, true}) {
        DriveChannel& channel = turns ? drive.turn : drive.way;
        const std::size_t o = turns ? 2 : 0;
        channel.errors = turns ? kDifferenceErrors : kMeanErrors;
        for (std::size_t i = 0; i < rows; ++i) {
            const double way = (wheels.left[i] + wheels.right[i]) / 2,
                         apart = wheels.right[i] - wheels.left[i];
            channel.counted.push_back(turns ? apart : way);
            channel.gain_with.push_back(gain_of_row(*model, with, turns, way, apart));
            channel.gain_without.push_back(gain_of_row(*model, none.values, turns, way, apart));
        }
        fill_channel(channel, observables[o].y, lacking[o].mean, having[o].mean, drive.starts);
    }
    for (std::size_t i = 0; i < rows; ++i)
        drive.spans.push_back(drive.starts[i] != 0 ? 0.0 : wheels.time[i] - wheels.time[i - 1]);
    return drive;
}

NotIdentified not_by_counts(const Study& study, const Fit& fit) {
    std::vector<std::size_t> through;
    for (const std::size_t effect : fit.effects)
        if (study.candidates()[effect].effect->through_counts) through.push_back(effect);
    if (through.empty()) return {};
    std::size_t tried = 0;
    for (const Candidate& candidate : study.candidates())
        tried += candidate.remark.empty() ? 1 : 0;
    const auto doubt = [&](std::span<const std::size_t> effects) -> std::string {
        const CountedDrive drive = drive_of(study, fit, effects);
        return drive.starts.empty() ? "" : hidden_by_counters(drive, needed_gain(tried, effects.size()));
    };
    if (std::string why = doubt(through); !why.empty()) return {through, std::move(why)};
    if (through.size() < 2) return {};
    NotIdentified result;
    for (const std::size_t effect : through)
        if (std::string why = doubt({&effect, 1}); !why.empty()) {
            result.effects.push_back(effect);
            result.why += (result.why.empty() ? "" : "; ") + why;
        }
    return result;
}

}  // namespace puckloop::gap
