#include "firmware/host/input.h"

namespace hosted {

puckloop::cosim::UartFrame character(std::uint8_t data, puckloop::cosim::Time now,
                                     puckloop::cosim::Time bit) {
    puckloop::cosim::UartFrame frame;
    constexpr int kBitsBeforeStop = 9;
    frame.start = now - kBitsBeforeStop * bit;
    frame.bit_period = bit;
    frame.data = data;
    return frame;
}

std::vector<double> ircom_halves(std::uint16_t symbols, double scale) {
    constexpr int kSymbols = 12, kMarkHalves = 10, kSpaceHalves = 5;
    constexpr double kMark = 261.0, kSpace = 521.4;
    std::vector<double> halves;
    for (int bit = kSymbols - 1; bit >= 0; --bit) {
        const bool space = symbols >> bit & 1;
        for (int i = 0; i < (space ? kSpaceHalves : kMarkHalves); ++i)
            halves.push_back((space ? kSpace : kMark) * scale);
    }
    return halves;
}

std::uint16_t ircom_symbols(std::uint8_t word) {
    const auto check = -static_cast<unsigned>(__builtin_popcount(word)) & 3u;
    return static_cast<std::uint16_t>(static_cast<unsigned>(word) << 2 | check);
}

}  // namespace hosted
