#include "protocols/infrared/rc5.h"

namespace puckloop::protocols {

std::vector<Rc5Edge> rc5_frame(bool toggle, int address, int command) {
    constexpr unsigned kStartBits = 0b11;
    const unsigned frame = kStartBits << 12 | (toggle ? 1U : 0U) << 11 |
                           (static_cast<unsigned>(address) & 31U) << 6 |
                           (static_cast<unsigned>(command) & 63U);
    std::vector<Rc5Edge> edges;
    bool high = true;
    const auto level = [&](int half, bool now) {
        if (now != high) edges.push_back({half * kRc5HalfBitMicroseconds, now});
        high = now;
    };
    for (int bit = 0; bit < kRc5Bits; ++bit) {
        const bool one = (frame >> (kRc5Bits - 1 - bit) & 1U) != 0;
        level(2 * bit, one);
        level(2 * bit + 1, !one);
    }
    level(2 * kRc5Bits, true);
    return edges;
}

}  // namespace puckloop::protocols
