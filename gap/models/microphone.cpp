// The level of a microphone before a loudspeaker: the stated level at 0.1 m, falling with the distance.
//
// The law is the simulator's (physics/sensors/sound.h). With "microphone.gaussian" = 1 the sound is known to
// be Gaussian noise, as the simulator's loudspeakers make it: a level then falls with lost samples as the
// range of so many normal samples, and scatters as that range.
//
// Deviations: 1. the converter's own noise is left out (in a run it adds to the sound's as powers). 2. Level
// is taken as the firmware reports it (largest minus smallest of a window).

#include "gap/models/model.h"
#include "gap/models/model_of.h"
#include "gap/models/rows.h"
#include "gap/models/sample_range.h"
#include "physics/description/robot_constants.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kReference = 0.1;  // m
constexpr double kLevel = 300.0;    // counts at the reference, where nothing is stated
constexpr double kWindow = 100.0;   // samples of the firmware's buffer

struct Numbers {
    double level = 0.0, exponent = 0.0, directivity = 0.0, self_noise = 0.0, motor_noise = 0.0,
           window_lost = 0.0, gaussian = 0.0, warmup_gain = 0.0, warmup_time = 0.0;
};

class MicrophoneModel final : public ModelOf<Numbers> {
  public:
    explicit MicrophoneModel(const Experiment& experiment) {
        const Rows rows(experiment, "mic", {"distance_m", "level"});
        std::vector<std::uint32_t> used;
        observables_.push_back(rows.observable("level", NoiseKind::Carry, used));
        const auto column = [&](std::string_view name, double fallback) {
            return taken(rows.column(name, fallback), used);
        };
        distance_ = column("distance_m", 0);
        angle_ = column("angle_rad", 0);
        amplitude_ = column("amplitude", 0);
        window_ = column("window", kWindow);
        motor_ = column("motor_speed", 0);
        time_ = column("t_s", 0);
        for (const double mic : column("mic", 0))
            mic_.push_back(static_cast<int>(mic));
        number(&Numbers::level, "microphone.level", "counts", kLevel);
        number(&Numbers::exponent, "microphone.exponent", "1", 1.0);
        number(&Numbers::directivity, "microphone.directivity", "1", 0.0);
        number(&Numbers::self_noise, "microphone.self_noise", "counts", 0.0);
        number(&Numbers::motor_noise, "microphone.motor_noise", "counts", 0.0);
        number(&Numbers::window_lost, "microphone.window_lost", "1", 0.0);
        number(&Numbers::gaussian, "microphone.gaussian", "1", 0.0);
        number(&Numbers::warmup_gain, "microphone.warmup_gain", "1", 0.0);
        number(&Numbers::warmup_time, "microphone.warmup_time", "s", 300.0);
        for (const int mic : mic_)
            if (gain_[static_cast<std::size_t>(mic)] < 0)
                gain_[static_cast<std::size_t>(mic)] = add(fmt::format("microphone.gain{}", mic), "1", 1.0);
        apply_nominal(experiment);
    }

    void predict(const std::vector<double>& v, Prediction& out) const override {
        out.resize(1);
        auto& mean = out[0].mean;
        mean.resize(distance_.size());
        const auto value = [&](int index) { return v[static_cast<std::size_t>(index)]; };
        const Numbers now = numbers(v);
        const double warm = now.warmup_gain, lost = now.window_lost;
        const bool gaussian = now.gaussian != 0.0;
        out[0].extra.assign(gaussian ? mean.size() : 0, 0.0);
        Window window{};
        for (std::size_t i = 0; i < mean.size(); ++i) {
            double level = amplitude_[i] > 0 ? amplitude_[i] : now.level;
            level *= std::pow(kReference / std::max(distance_[i], 1e-3), now.exponent);
            level *=
                (1 + now.directivity * std::cos(angle_[i])) * value(gain_[static_cast<std::size_t>(mic_[i])]);
            if (warm != 0.0) level *= 1 + warm * (1 - std::exp(-std::max(time_[i], 0.0) / now.warmup_time));
            level += now.self_noise + now.motor_noise * std::abs(motor_[i]) / physics::kSpeedUnit;
            if (gaussian) {
                window.become(window_[i], lost);
                level *= window.share;
                out[0].extra[i] = std::abs(level) * window.scatter;
            } else if (lost != 0.0)  // Extremes of N samples lie about sqrt(2 ln N) from the mean.
                level *= std::sqrt(std::log(std::max(window_[i] * (1 - lost), 2.0)) /
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
    std::array<int, 8> gain_{-1, -1, -1, -1, -1, -1, -1, -1};
};

}  // namespace

std::unique_ptr<Model> make_microphone_model(const Experiment& experiment) {
    return std::make_unique<MicrophoneModel>(experiment);
}

}  // namespace puckloop::gap
