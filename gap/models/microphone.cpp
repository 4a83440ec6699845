// The level of a microphone before a loudspeaker: the stated level at 0.1 m, falling with the distance.
//
// The law is the simulator's (physics/sensors/sound.h). With "microphone.gaussian" = 1 the sound is known to
// be Gaussian noise, as the simulator's loudspeakers make it: a level then falls with lost samples as the
// range of so many normal samples, and scatters as that range.
//
// Deviations: 1. the converter's own noise is left out (in a run it adds to the sound's as powers). 2. Level
// is taken as the firmware reports it (largest minus smallest of a window).

#include "gap/models/model_of.h"
#include "gap/models/rows.h"
#include "gap/stats/tails.h"
#include "physics/description/robot_constants.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr double kReference = 0.1;  // m
constexpr double kLevel = 300.0;    // counts at the reference, where nothing is stated
constexpr double kWindow = 100.0;   // samples of the firmware's buffer

constexpr double kFar = 7.0;     // deviations: nothing is beyond
constexpr double kStep = 0.025;  // trapezoids; exact to 1e-6 for so smooth a function

/// Largest minus smallest, expected for n (2 or more, whole or not) independent standard normal
/// samples: 1.128 for 2, 5.015 for 100.
double normal_range(double n) {
    // E(max - min) = integral of the probability that some sample is above x and some below
    double sum = 0.0;
    for (double x = 0.0; x < kFar; x += kStep) {
        const double below = stats::normal_tail(-x), above = 1.0 - below;
        const double between = 1.0 - std::pow(below, n) - std::pow(above, n);
        sum += x == 0.0 ? between / 2 : between;
    }
    return 2.0 * sum * kStep;  // even in x
}

/// Its standard deviation, by the extremes' limiting law: within 2 % of 0.605 for 100, 5 % of 0.797 for 10.
double normal_range_sd(double n) {
    return std::numbers::pi / std::numbers::sqrt3 / std::sqrt(2.0 * std::log(n));
}

struct MicrophoneNumbers : physics::Parameters {
    double level = kLevel, gaussian = 0.0;
    std::array<double, 8> gain{1, 1, 1, 1, 1, 1, 1, 1};  // of more than the simulator's robot has
};

class MicrophoneModel final : public ModelOf<MicrophoneNumbers> {
  public:
    explicit MicrophoneModel(const Experiment& experiment) {
        const Rows rows(experiment, "mic", {"distance_m", "level"});
        std::vector<double> mic;
        observables_.push_back(rows.observable("level", NoiseKind::Carry,
                                               {{distance_, "distance_m"},
                                                {angle_, "angle_rad"},
                                                {amplitude_, "amplitude"},
                                                {window_, "window", kWindow},
                                                {motor_, "motor_speed"},
                                                {time_, "t_s"},
                                                {mic, "mic"}}));
        mic_ = whole(mic);
        declare({{&MicrophoneNumbers::level, "microphone.level", "counts"}});
        simulated("microphone.", {"exponent", "directivity", "self_noise", "motor_noise", "window_lost"});
        declare({{&MicrophoneNumbers::gaussian, "microphone.gaussian", "1"}});
        simulated("microphone.", {"warmup_gain", "warmup_time"});
        for (const int one : in_order_met(mic_))
            declare_part(&MicrophoneNumbers::gain, static_cast<std::size_t>(one), "microphone.gain", one,
                         "1");
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(1);
        auto& mean = out[0].mean;
        mean.resize(distance_.size());
        const MicrophoneNumbers now = numbers(v);
        const physics::MicrophoneParameters& mic = now.microphone;
        const bool gaussian = now.gaussian != 0.0;
        out[0].extra.assign(gaussian ? mean.size() : 0, 0.0);
        Window window{};
        for (std::size_t i = 0; i < mean.size(); ++i) {
            double level = amplitude_[i] > 0 ? amplitude_[i] : now.level;
            level *= std::pow(kReference / std::max(distance_[i], 1e-3), mic.exponent);
            level *=
                (1 + mic.directivity * std::cos(angle_[i])) * now.gain[static_cast<std::size_t>(mic_[i])];
            level *= 1 + warmed(mic.warmup_gain, time_[i], mic.warmup_time);
            level += mic.self_noise + mic.motor_noise * std::abs(motor_[i]) / physics::kSpeedUnit;
            if (gaussian) {
                window.become(window_[i], mic.window_lost);
                level *= window.share;
                out[0].extra[i] = std::abs(level) * window.scatter;
            } else if (mic.window_lost != 0.0)  // Extremes of N samples lie about sqrt(2 ln N) from the mean.
                level *= std::sqrt(std::log(std::max(window_[i] * (1 - mic.window_lost), 2.0)) /
                                   std::log(std::max(window_[i], 2.0)));
            mean[i] = level;
        }
    }

  private:
    /// Of Gaussian sound: what lost samples leave of a level, and how far one level scatters, in parts of it.
    struct Window {
        double samples = -1.0, share = 1.0, scatter = 0.0;
        void become(double of, double lost) {
            if (of == samples) return;
            samples = of;
            const double all = std::max(of, 2.0), used = std::max(of * (1 - lost), 2.0);
            const double range = normal_range(used);
            share = lost != 0.0 ? range / normal_range(all) : 1.0;
            scatter = normal_range_sd(used) / range;
        }
    };
    std::vector<double> distance_, angle_, amplitude_, window_, motor_, time_;
    std::vector<int> mic_;
};

}  // namespace

std::unique_ptr<Model> make_microphone_model(const Experiment& experiment) {
    return std::make_unique<MicrophoneModel>(experiment);
}

}  // namespace puckloop::gap
