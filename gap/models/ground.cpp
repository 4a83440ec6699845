// Ground sensors: the printed grey under a sensor as counts, in the order of physics::GroundRow: black and
// white level, height, gain, offset, saturation.
//
// Deviations: 1. the footprint is the experiment's: `grey` is the mean under the nominal one. 2. Where a
// sensor stands ahead or answers late, the grey there is read off the sensor's own track (cubic between rows,
// a straight line beyond its ends); aside it goes along the stated slope.

#include "gap/models/model_of.h"
#include "gap/models/rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kNoWay = 1e-6;     // m: less is no way
constexpr double kSameGrey = 0.01;  // beyond the scatter of a standing robot's truth

struct GroundNumbers : physics::Parameters {
    double raised = 0.0, forward_error = 0.0, left_error = 0.0, ambient_offset = 0.0;
};

class GroundModel final : public ModelOf<GroundNumbers> {
  public:
    explicit GroundModel(const Experiment& experiment) {
        const Rows rows(experiment, "sensor", {"grey", "reading"});
        std::vector<double> sensor;
        observables_.push_back(rows.observable("reading", NoiseKind::Carry,
                                               {{grey_, "grey"},
                                                {along_, "grey_rate"},
                                                {across_, "grey_across"},
                                                {speed_, "speed"},
                                                {pitch_, "pitch_rad"},
                                                {acceleration_, "acceleration"},
                                                {ambient_, "ambient"},
                                                {time_, "t_s"},
                                                {sensor, "sensor"}}));
        lay_track();
        sensor_ = whole(sensor);
        simulated("ground.", {"black", "white", "saturation", "height_slope", "x"});
        declare({{&GroundNumbers::raised, "ground.raised", "m"}});
        simulated("ground.", {"acceleration_tilt"});
        declare({{&GroundNumbers::forward_error, "ground.forward_error", "m"},
                 {&GroundNumbers::left_error, "ground.left_error", "m"}});
        simulated("ground.", {"lag"});
        declare({{&GroundNumbers::ambient_offset, "ground.ambient_offset", "counts"}});
        simulated("ground.", {"warmup_gain", "warmup_time"});
        for (const int one : in_order_met(sensor_))
            simulated("ground.", {fmt::format("gain{}", one), fmt::format("offset{}", one)});
        apply_nominal(experiment);
        if (std::isnan(observables_[0].instrument.ceiling))
            observables_[0].instrument.ceiling = nominal().ground.saturation;
        if (std::isnan(observables_[0].instrument.floor)) observables_[0].instrument.floor = 0;
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(1);
        auto& mean = out[0].mean;
        mean.resize(grey_.size());
        const GroundNumbers now = numbers(v);
        const physics::GroundParameters& ground = now.ground;
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const auto s = static_cast<std::size_t>(sensor_[i]);
            const double ahead = now.forward_error - way_since(i, ground.lag);
            const double grey = grey_ahead(i, ahead) + now.left_error * across_[i];
            const double lift =
                now.raised + ground.x * std::sin(pitch_[i] + ground.acceleration_tilt * acceleration_[i]);
            double level =
                (ground.black + (ground.white - ground.black) * grey) * (1 - ground.height_slope * lift);
            level *= 1 + warmed(ground.warmup_gain, time_[i], ground.warmup_time);
            mean[i] = ground.gain[s] * level + ground.offset[s] + now.ambient_offset * ambient_[i];
        }
    }

  private:
    /// Way along each chain, by the mean of the speeds at both ends of a step.
    void lay_track() {
        way_.assign(grey_.size(), 0.0);
        for (std::size_t i = 1; i < way_.size(); ++i)
            if (goes_on(i))
                way_[i] = way_[i - 1] + (speed_[i] + speed_[i - 1]) / 2 * (time_[i] - time_[i - 1]);
    }

    /// Is row i there, and of the same chain as the one before?
    bool goes_on(std::size_t i) const { return i < way_.size() && observables_[0].starts[i] == 0; }

    /// Way driven in the time `lag` before row i; before the chain began, as if its speed had been the same.
    double way_since(std::size_t i, double lag) const {
        if (lag == 0.0) return 0.0;
        const double then = time_[i] - lag;
        std::size_t k = i;
        while (lag > 0 && goes_on(k) && time_[k] > then)
            --k;
        while (lag < 0 && goes_on(k + 1) && time_[k + 1] <= then)
            ++k;
        if (!goes_on(k + 1) || time_[k] > then) return way_[i] - way_[k] + (time_[k] - then) * speed_[k];
        const double share = (then - time_[k]) / std::max(time_[k + 1] - time_[k], 1e-9);
        return way_[i] - way_[k] - share * (way_[k + 1] - way_[k]);
    }

    /// Does row k + 1 see another grey than row k though the wheels made no way between them? Then the robot
    /// was carried, and the track of one says nothing of the other's place.
    bool carried(std::size_t k) const {
        return std::abs(way_[k + 1] - way_[k]) < kNoWay && std::abs(grey_[k + 1] - grey_[k]) > kSameGrey;
    }

    /// The grey `ahead` metres farther on (or back) along the track of row i.
    double grey_ahead(std::size_t i, double ahead) const {
        if (ahead == 0.0) return grey_[i];
        const double at = way_[i] + ahead;
        const double sense = speed_[i] < 0 ? -1.0 : 1.0;  // rows run the other way when the robot backs up
        std::size_t k = i;
        const auto behind = [&](std::size_t row) { return sense * (way_[row] - at) > 0; };
        while (goes_on(k) && behind(k) && sense * (way_[k - 1] - way_[k]) <= 0 && !carried(k - 1))
            --k;
        while (goes_on(k + 1) && !behind(k + 1) && sense * (way_[k + 1] - way_[k]) >= 0 && !carried(k))
            ++k;
        const double rest = at - way_[k];
        const double step = goes_on(k + 1) ? way_[k + 1] - way_[k] : 0.0;
        if (behind(k) || std::abs(step) < kNoWay || sense * (at - way_[k] - step) > 0)
            return grey_[k] + rest * along_[k];
        const double u = rest / step, v = 1 - u;  // Hermite's cubic through both greys and slopes
        return (1 + 2 * u) * v * v * grey_[k] + u * v * v * step * along_[k] +
               (3 - 2 * u) * u * u * grey_[k + 1] - u * u * v * step * along_[k + 1];
    }

    std::vector<double> way_;
    std::vector<double> grey_, along_, across_, speed_, pitch_, acceleration_, ambient_, time_;
    std::vector<int> sensor_;
};

}  // namespace

std::unique_ptr<Model> make_ground_model(const Experiment& experiment) {
    return std::make_unique<GroundModel>(experiment);
}

}  // namespace puckloop::gap
