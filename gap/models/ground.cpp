// Ground sensors: the printed grey under a sensor as counts, in the order of physics::GroundRow: black and
// white level, height, gain, offset, saturation.
//
// Deviations: 1. the footprint is the experiment's: `grey` is the mean under the nominal one. 2. Where a
// sensor stands ahead or answers late, the grey there is read off the sensor's own track (cubic between rows,
// a straight line beyond its ends); aside it goes along the stated slope.

#include "gap/models/model.h"
#include "gap/models/rows.h"
#include "physics/description/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kStill = 1e-6;     // m: less is no way
constexpr double kSameGrey = 0.01;  // beyond the scatter of a standing robot's truth

class GroundModel final : public Model {
  public:
    explicit GroundModel(const Experiment& experiment) {
        const Rows rows(experiment, "sensor", {"grey", "reading"});
        std::vector<std::uint32_t> used;
        observables_.push_back(rows.observable("reading", NoiseKind::Carry, used));
        const auto column = [&](std::string_view name, double fallback) {
            return taken(rows.column(name, fallback), used);
        };
        grey_ = column("grey", 0);
        along_ = column("grey_rate", 0);
        across_ = column("grey_across", 0);
        speed_ = column("speed", 0);
        pitch_ = column("pitch_rad", 0);
        acceleration_ = column("acceleration", 0);
        ambient_ = column("ambient", 0);
        time_ = column("t_s", 0);
        lay_track();
        for (const double sensor : column("sensor", 0))
            sensor_.push_back(static_cast<int>(sensor));
        const physics::Parameters defaults;
        black_ = add("ground.black", "counts", defaults.ground.black);
        white_ = add("ground.white", "counts", defaults.ground.white);
        saturation_ = add("ground.saturation", "counts", defaults.ground.saturation);
        height_slope_ = add("ground.height_slope", "1/m", defaults.ground.height_slope);
        x_ = add("ground.x", "m", defaults.ground.x);
        raised_ = add("ground.raised", "m", 0.0);
        tilt_ = add("ground.acceleration_tilt", "rad s2/m", 0.0);
        forward_ = add("ground.forward_error", "m", 0.0);
        left_ = add("ground.left_error", "m", 0.0);
        lag_ = add("ground.lag", "s", 0.0);
        light_ = add("ground.ambient_offset", "counts", 0.0);
        warmup_ = add("ground.warmup_gain", "1", 0.0);
        warmup_time_ = add("ground.warmup_time", "s", 300.0);
        for (const int sensor : sensor_) {
            const auto s = static_cast<std::size_t>(sensor);
            if (gain_[s] >= 0) continue;
            gain_[s] = add(fmt::format("ground.gain{}", s), "1", 1.0);
            offset_[s] = add(fmt::format("ground.offset{}", s), "counts", 0.0);
        }
        apply_nominal(experiment);
        if (std::isnan(observables_[0].instrument.ceiling))
            observables_[0].instrument.ceiling = parameters_[static_cast<std::size_t>(saturation_)].neutral;
        if (std::isnan(observables_[0].instrument.floor)) observables_[0].instrument.floor = 0;
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(1);
        auto& mean = out[0].mean;
        mean.resize(grey_.size());
        const auto value = [&](int index) { return v[static_cast<std::size_t>(index)]; };
        const double black = value(black_), contrast = value(white_) - black, slope = value(height_slope_),
                     warm = value(warmup_);
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const auto s = static_cast<std::size_t>(sensor_[i]);
            const double ahead = value(forward_) - way_since(i, value(lag_));
            const double grey = grey_ahead(i, ahead) + value(left_) * across_[i];
            const double lift =
                value(raised_) + value(x_) * std::sin(pitch_[i] + value(tilt_) * acceleration_[i]);
            double level = (black + contrast * grey) * (1 - slope * lift);
            if (warm != 0.0)
                level *= 1 + warm * (1 - std::exp(-std::max(time_[i], 0.0) / value(warmup_time_)));
            mean[i] = value(gain_[s]) * level + value(offset_[s]) + value(light_) * ambient_[i];
        }
    }

  private:
    /// Way along each chain, by the mean of the speeds at both ends of a step.
    void lay_track() {
        const Observable& o = observables_[0];
        const std::size_t n = grey_.size();
        way_.assign(n, 0.0);
        first_.assign(n, 0);
        last_.assign(n, 0);
        for (std::size_t i = 0; i < n; ++i) {
            const bool begins = i == 0 || o.starts[i] != 0;
            first_[i] = begins ? i : first_[i - 1];
            if (!begins) way_[i] = way_[i - 1] + (speed_[i] + speed_[i - 1]) / 2 * (time_[i] - time_[i - 1]);
        }
        for (std::size_t i = n; i-- > 0;)
            last_[i] = i + 1 == n || first_[i + 1] == i + 1 ? i : last_[i + 1];
    }

    /// Way driven in the time `lag` before row i; before the chain began, as if its speed had been the same.
    double way_since(std::size_t i, double lag) const {
        if (lag == 0.0) return 0.0;
        const double then = time_[i] - lag;
        std::size_t k = i;
        while (lag > 0 && k > first_[i] && time_[k] > then)
            --k;
        while (lag < 0 && k < last_[i] && time_[k + 1] <= then)
            ++k;
        if (k == last_[i] || time_[k] > then) return way_[i] - way_[k] + (time_[k] - then) * speed_[k];
        const double share = (then - time_[k]) / std::max(time_[k + 1] - time_[k], 1e-9);
        return way_[i] - way_[k] - share * (way_[k + 1] - way_[k]);
    }

    /// Does row k + 1 see another grey than row k though the wheels made no way between them? Then the robot
    /// was carried, and the track of one says nothing of the other's place.
    bool carried(std::size_t k) const {
        return std::abs(way_[k + 1] - way_[k]) < kStill && std::abs(grey_[k + 1] - grey_[k]) > kSameGrey;
    }

    /// The grey `ahead` metres farther on (or back) along the track of row i.
    double grey_ahead(std::size_t i, double ahead) const {
        if (ahead == 0.0) return grey_[i];
        const double at = way_[i] + ahead;
        const double sense = speed_[i] < 0 ? -1.0 : 1.0;  // rows run the other way when the robot backs up
        std::size_t k = i;
        const auto behind = [&](std::size_t row) { return sense * (way_[row] - at) > 0; };
        while (k > first_[i] && behind(k) && sense * (way_[k - 1] - way_[k]) <= 0 && !carried(k - 1))
            --k;
        while (k < last_[i] && !behind(k + 1) && sense * (way_[k + 1] - way_[k]) >= 0 && !carried(k))
            ++k;
        const double rest = at - way_[k];
        const double step = k < last_[i] ? way_[k + 1] - way_[k] : 0.0;
        if (behind(k) || std::abs(step) < kStill || sense * (at - way_[k] - step) > 0)
            return grey_[k] + rest * along_[k];
        const double u = rest / step, v = 1 - u;  // Hermite's cubic through both greys and slopes
        return (1 + 2 * u) * v * v * grey_[k] + u * v * v * step * along_[k] +
               (3 - 2 * u) * u * u * grey_[k + 1] - u * u * v * step * along_[k + 1];
    }

    std::vector<double> way_;
    std::vector<std::size_t> first_, last_;  // row of the chain that this row is in
    std::vector<double> grey_, along_, across_, speed_, pitch_, acceleration_, ambient_, time_;
    std::vector<int> sensor_;
    std::array<int, physics::kGroundSensors> gain_{-1, -1, -1}, offset_{-1, -1, -1};
    int black_ = 0, white_ = 0, saturation_ = 0, height_slope_ = 0, x_ = 0, raised_ = 0, tilt_ = 0,
        forward_ = 0, left_ = 0, lag_ = 0, light_ = 0, warmup_ = 0, warmup_time_ = 0;
};

}  // namespace

std::unique_ptr<Model> make_ground_model(const Experiment& experiment) {
    return std::make_unique<GroundModel>(experiment);
}

}  // namespace puckloop::gap
