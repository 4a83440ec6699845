#pragma once
// A codec in master mode at the data converter interface: it makes bit clock, frame sync or both, sends a
// ramp of 16-bit words and keeps what it is sent.

#include "emu/dspic/peripherals/pins.h"

#include <cmath>
#include <cstdint>
#include <vector>

namespace puckloop::dspic::test {

/// A bit clock of `hertz` from `first` on; 0: none. Frame syncs every `frame_bits` bits; 0: none.
inline DciMaster codec_clocks(double hertz, std::uint32_t frame_bits, cosim::Time first) {
    return {first, hertz > 0.0 ? static_cast<cosim::Time>(std::llround(1e12 / hertz)) : 0, frame_bits};
}

struct MasterCodec {
    DciMaster clocks{};
    std::vector<DciWord> heard{};
    std::vector<Cycle> times{};

    /// The word sent while the `number`th was heard, from 0 on.
    static std::uint16_t sent(std::size_t number) {
        return static_cast<std::uint16_t>(0x1234 + 0x101 * number);
    }

    std::uint16_t exchange(const DciWord& word, Cycle now) {
        heard.push_back(word);
        times.push_back(now);
        return sent(heard.size() - 1);
    }
};

}  // namespace puckloop::dspic::test
