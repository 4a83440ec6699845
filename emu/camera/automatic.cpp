#include "emu/camera/automatic.h"

#include <algorithm>
#include <cmath>

namespace puckloop::camera {

namespace {

constexpr double kBrightestLevel = 255.0;
constexpr double kWhiteSpeed = 1.0 / 8;
constexpr double kFastest = 4.0;  // of what is missing, in one frame
constexpr std::uint64_t kFewestGrey = 16;
constexpr std::size_t kRed = 0, kGreen = 1, kBlue = 2;
constexpr std::array kShares{0.299, 0.587, 0.114};  // ITU-R BT.601

}  // namespace

SeenLight::SeenLight(std::span<const std::uint8_t> rgb) : pixels(rgb.size() / 3) {
    for (std::size_t i = 0; i + 2 < rgb.size(); i += 3) {
        const auto pixel = rgb.subspan(i, 3);
        for (std::size_t c = 0; c < 3; ++c)
            ++levels[c][pixel[c]];
        const auto [least, most] = std::minmax({pixel[kRed], pixel[kGreen], pixel[kBlue]});
        if (most > 2 * least) continue;
        ++grey;
        for (std::size_t c = 0; c < 3; ++c)
            grey_sum[c] += pixel[c];
    }
}

double SeenLight::brightness(const std::array<double, 3>& gain) const {
    if (pixels == 0) return 0.0;
    double sum = 0.0;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < levels[c].size(); ++i)
            sum +=
                kShares[c] * levels[c][i] * std::min(static_cast<double>(i) / kBrightestLevel * gain[c], 1.0);
    return sum / static_cast<double>(pixels);
}

std::array<double, 3> AutomaticControl::gain(const AutomaticSettings& settings,
                                             const std::array<double, 3>& manual) const {
    std::array<double, 3> gain = manual;
    if (settings.white) {
        gain[kRed] *= white_[0];
        gain[kBlue] *= white_[1];
    }
    if (settings.exposure)
        for (double& each : gain)
            each *= exposure_;
    return gain;
}

void AutomaticControl::frame(const SeenLight& light, const AutomaticSettings& settings,
                             const std::array<double, 3>& manual) {
    const double mean = light.brightness(gain(settings, manual));
    if (settings.exposure && std::abs(mean - settings.reference) > settings.margin) {
        const double missing = mean > 0.0 ? std::min(settings.reference / mean, kFastest) : kFastest;
        exposure_ *= 1.0 + (missing > 1.0 ? settings.rise : settings.fall) * (missing - 1.0);
    }
    exposure_ = std::clamp(exposure_, settings.least, std::max(settings.least, settings.most));
    if (!settings.white || light.grey * kFewestGrey < light.pixels) return;
    for (std::size_t i = 0; i < white_.size(); ++i) {
        const std::uint64_t sum = light.grey_sum[i == 0 ? kRed : kBlue];
        if (sum == 0) continue;
        const double wanted = static_cast<double>(light.grey_sum[kGreen]) / static_cast<double>(sum);
        white_[i] += kWhiteSpeed * (wanted - white_[i]);
        white_[i] = std::clamp(white_[i], settings.white_least[i],
                               std::max(settings.white_least[i], settings.white_most[i]));
    }
}

}  // namespace puckloop::camera
