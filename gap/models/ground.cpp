// Ground sensors: the printed grey under a sensor as counts, in the order of physics::GroundRow: black and
// white level, height, gain, offset, saturation.
//
// Deviations: 1. the footprint is the experiment's: `grey` is the mean under the nominal one. 2. A shift of
// the sensor moves along the stated slope of the grey.

#include "gap/models/model.h"
#include "gap/models/rows.h"
#include "physics/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap {

namespace {

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
            const double ahead = value(forward_) - value(lag_) * speed_[i];
            const double grey = grey_[i] + ahead * along_[i] + value(left_) * across_[i];
            const double lift =
                value(raised_) + value(x_) * std::sin(pitch_[i] + value(tilt_) * acceleration_[i]);
            double level = (black + contrast * grey) * (1 - slope * lift);
            if (warm != 0.0)
                level *= 1 + warm * (1 - std::exp(-std::max(time_[i], 0.0) / value(warmup_time_)));
            mean[i] = value(gain_[s]) * level + value(offset_[s]) + value(light_) * ambient_[i];
        }
    }

  private:
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
