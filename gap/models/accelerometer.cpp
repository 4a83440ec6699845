// The accelerometer: acceleration and gravity as counts, axes right, rear, up, as physics::Accelerometer has
// them.
//
// Deviations: 1. gravity is turned exactly by pitch and roll; the world model takes them as small. 2. The low
// pass of 150 Hz is left out: rows are 10 ms and more apart.

#include "gap/models/gravity.h"
#include "gap/models/model_of.h"
#include "gap/models/rows.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr const char* kAxes[] = {"ax", "ay", "az"};

class AccelerometerModel final : public ModelOf<physics::Parameters> {
  public:
    explicit AccelerometerModel(const Experiment& experiment) {
        const Rows rows(experiment, "", {});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::vector<double> pitch, roll, forward, left;
            Axis& one = axes_[axis];
            observables_.push_back(rows.observable(kAxes[axis], NoiseKind::Carry,
                                                   {{pitch, "pitch_rad"},
                                                    {roll, "roll_rad"},
                                                    {forward, "acceleration"},
                                                    {left, "lateral"},
                                                    {one.motor, "motor_speed"},
                                                    {one.time, "t_s"},
                                                    {one.session, "session"}}));
            for (std::size_t i = 0; i < pitch.size(); ++i) {
                const double sp = std::sin(pitch[i]), cp = std::cos(pitch[i]), sr = std::sin(roll[i]),
                             cr = std::cos(roll[i]);
                one.felt.push_back({-left[i] * cr / kGravity - cp * sr, -forward[i] * cp / kGravity - sp,
                                    cp * cr - forward[i] * sp / kGravity - left[i] * sr / kGravity});
            }
            for (double& speed : one.motor)
                speed = std::abs(speed) / physics::kSpeedUnit;
        }
        declare_all();
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(3);
        const physics::AccelerometerParameters now = numbers(v).accelerometer;
        const double c = std::cos(now.turn), s = std::sin(now.turn);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const Axis& one = axes_[axis];
            Predicted& p = out[axis];
            p.mean.resize(one.felt.size());
            for (std::size_t i = 0; i < p.mean.size(); ++i) {
                const auto& felt = one.felt[i];
                const double seen = axis == 0   ? c * felt[0] + s * felt[1]
                                    : axis == 1 ? c * felt[1] - s * felt[0]
                                                : felt[2];
                double counts = now.zero + now.bias[axis] + now.gain * now.scale[axis] * seen;
                for (const auto& [session, index] : session_bias_[axis])
                    if (one.session[i] == session) counts += v[index];
                counts += warmed(now.warmup, one.time[i], now.warmup_time);
                p.mean[i] = counts * (1 - now.motor_sag * (one.motor[i] > 0 ? 1.0 : 0.0));
            }
            fill_rows(p.extra, p.mean.size(), now.vibration != 0.0,
                      [&](std::size_t i) { return now.vibration * one.motor[i]; });
        }
    }

  private:
    struct Axis {
        std::vector<std::array<double, 3>> felt;  // g; right, rear, up
        std::vector<double> motor, time, session;
    };

    void declare_all() {
        simulated("accelerometer.",
                  {"zero", "gain", "turn", "motor_sag", "warmup", "warmup_time", "vibration"});
        for (std::size_t axis = 0; axis < 3; ++axis) {
            simulated("accelerometer.", {fmt::format("bias{}", axis), fmt::format("scale{}", axis)});
            auto sessions = distinct(axes_[axis].session);
            for (std::size_t k = 1; k < std::min<std::size_t>(sessions.size(), 6); ++k)
                session_bias_[axis].emplace_back(
                    sessions[k],
                    add(fmt::format("accelerometer.session_bias{}{}", k + 1, axis), "counts", 0.0));
        }
    }

    std::array<Axis, 3> axes_;
    std::array<std::vector<std::pair<double, std::size_t>>, 3> session_bias_;
};

}  // namespace

std::unique_ptr<Model> make_accelerometer_model(const Experiment& experiment) {
    return std::make_unique<AccelerometerModel>(experiment);
}

}  // namespace puckloop::gap
