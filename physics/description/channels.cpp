#include "physics/description/channels.h"

namespace puckloop::physics {

namespace {
constexpr std::array<std::string_view, kChannelCount> kNames{
    "proximity0",      "proximity1",      "proximity2",      "proximity3",   "proximity4",    "proximity5",
    "proximity6",      "proximity7",      "ambient0",        "ambient1",     "ambient2",      "ambient3",
    "ambient4",        "ambient5",        "ambient6",        "ambient7",     "acc_x",         "acc_y",
    "acc_z",           "battery_v",       "battery_low",     "ground0",      "ground1",       "ground2",
    "ground_ambient0", "ground_ambient1", "ground_ambient2", "mic_level0",   "mic_level1",    "mic_level2",
    "mic_lost",        "lsm330_acc_x",    "lsm330_acc_y",    "lsm330_acc_z", "lsm330_rate_x", "lsm330_rate_y",
    "lsm330_rate_z"};
constexpr double kMillivolt = 1e-3;
constexpr double kLeastShare = 1e-4;
constexpr double kLeastForce = 5e-5, kLeastTurnRate = 1e-3;
}  // namespace

std::string_view channel_name(std::size_t channel) {
    return kNames[channel];
}

double channel_quantum(std::size_t channel, double count_quantum) {
    if (channel == kBatteryVoltageChannel) return kMillivolt;
    if (channel == kMicrophoneLostChannel) return kLeastShare;
    if (channel >= kForceChannel) return channel < kTurnRateChannel ? kLeastForce : kLeastTurnRate;
    const bool whole = channel >= kAccelerationChannel && channel != kBatteryLowChannel;
    return whole && count_quantum < 1.0 ? 1.0 : count_quantum;  // 10-bit and noisy channels: whole counts
}

}  // namespace puckloop::physics
