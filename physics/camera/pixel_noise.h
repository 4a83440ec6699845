#pragma once
// Noise of millions of pixels a second: one 64-bit draw a pixel, its 16-bit parts looked up in a table of the
// normal distribution's quantiles.

#include <array>
#include <cmath>
#include <cstdint>

namespace puckloop::physics {

using NoiseTable = std::array<float, 1024>;

/// Quantiles of the standard normal distribution at the middles of 1024 equal parts; standard deviation
/// 0.999.
inline const NoiseTable& noise_table() {
    static const NoiseTable table = [] {
        NoiseTable values{};
        for (std::size_t i = 0; i < values.size(); ++i) {
            const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(values.size());
            double low = -6.0, high = 6.0;  // bisection of the distribution function
            for (int k = 0; k < 40; ++k) {
                const double middle = (low + high) / 2;
                (0.5 * std::erfc(-middle / std::sqrt(2.0)) < share ? low : high) = middle;
            }
            values[i] = static_cast<float>((low + high) / 2);
        }
        return values;
    }();
    return table;
}

/// splitmix64 from a camera's seed and the frame's number.
class PixelNoise {
  public:
    PixelNoise(std::uint64_t seed, std::uint64_t frame) : state_(seed + frame * 0xd1342543de82ef95) {}
    std::uint64_t next() {
        state_ += 0x9e3779b97f4a7c15;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    }

  private:
    std::uint64_t state_;
};

}  // namespace puckloop::physics
