#include "protocols/infrared/rab_reading.h"

#include <cmath>

namespace puckloop::protocols {

namespace {

struct Direction {
    float radians, cosine, sine;
};

// Receivers at 15 50 75 105 133 159 -165 -135 -105 -77 -50 -15 degrees; the image holds six decimals.
constexpr std::array<Direction, kRabSensors> kSensors{{{0.261799F, 0.965926F, 0.258819F},
                                                       {0.872665F, 0.642788F, 0.766044F},
                                                       {1.308997F, 0.258819F, 0.965926F},
                                                       {1.832596F, -0.258819F, 0.965926F},
                                                       {2.321288F, -0.681998F, 0.731354F},
                                                       {2.775074F, -0.933580F, 0.358368F},
                                                       {-2.879793F, -0.965926F, -0.258819F},
                                                       {-2.356194F, -0.707107F, -0.707107F},
                                                       {-1.832596F, -0.258819F, -0.965926F},
                                                       {-1.343904F, 0.224951F, -0.974370F},
                                                       {-0.872665F, 0.642788F, -0.766044F},
                                                       {-0.261799F, 0.965926F, -0.258819F}}};

/// P^4 / cos^2 of the angle between the bearing and the sensor.
float share(int peak, float bearing, std::size_t sensor) {
    const auto p = static_cast<float>(peak);
    const float cosine = std::cos(bearing - kSensors[sensor].radians);
    return p * p * p * p / (cosine * cosine);
}

}  // namespace

RabReading rab_reading(const std::array<int, kRabSensors>& peaks) {
    float x = 0.0F;
    float y = 0.0F;
    std::size_t first = 0;
    std::size_t second = 0;
    int first_peak = 0;
    int second_peak = 0;
    for (std::size_t i = 0; i < peaks.size(); ++i) {
        const int peak = peaks[i];
        if (peak <= 0) continue;
        x += static_cast<float>(peak) * kSensors[i].cosine;
        y += static_cast<float>(peak) * kSensors[i].sine;
        if (peak > first_peak) {
            second = first;
            second_peak = first_peak;
            first = i;
            first_peak = peak;
        } else if (peak > second_peak) {
            second = i;
            second_peak = peak;
        }
    }
    RabReading reading;
    if (first_peak == 0) return reading;
    const float bearing = x == 0.0F ? 0.0F : std::atan2(y, x);
    float sum = share(first_peak, bearing, first);
    if (second_peak > 0) sum += share(second_peak, bearing, second);
    reading.bearing = static_cast<std::int16_t>(bearing * 10000.0F);
    reading.range = static_cast<std::uint16_t>(std::sqrt(std::sqrt(sum)));
    reading.peak = static_cast<std::uint16_t>(first_peak);
    reading.sensor = static_cast<std::uint8_t>(first);
    return reading;
}

double rab_distance_cm(double strength, double gain) {
    constexpr double kOffset = 9.06422181283387;
    constexpr double kSlope = 0.00565074879677167;
    return gain * std::exp(kOffset - kSlope * strength);
}

}  // namespace puckloop::protocols
