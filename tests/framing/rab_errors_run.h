#pragma once
// Frames with wrong chips in front of a range-and-bearing board's real firmware: what it makes of them, and
// of the good frames that follow.

#include "tests/firmware/rab_bench.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::framing {

struct RabReceiver {
    std::string name, image;
    double ready = 0;     ///< s after power-up
    double readable = 0;  ///< s from a frame's last chip to its message, with margin
};
/// The project's own firmware; the original where PUCKLOOP_IMAGES has it.
RabReceiver own_rab_receiver();
std::vector<RabReceiver> rab_receivers();

/// What became of one wrong frame.
struct RabOutcome {
    bool accepted_right = false;  ///< its payload came through in spite of the error
    bool accepted_wrong = false;  ///< another payload came
    bool next_lost = false;       ///< the good frame after it did not come
    bool second_lost = false;     ///< nor the one after that
};

/// Every text is sent in turn, each followed by two good frames of `size` bits. `payload` is what the texts
/// had before the errors. Drawn payloads and phases from `seed`.
std::vector<RabOutcome> send_wrong_frames(const RabReceiver& receiver, int size, std::uint32_t payload,
                                          const std::vector<std::string>& texts, std::uint64_t seed);

struct Delivery {
    int sent = 0, right = 0, wrong = 0;
};
/// Good frames whose edges are each displaced by up to +-`jitter` chips, evenly drawn, and whose chips are
/// `longer` times the receiver's.
Delivery send_jittered(const RabReceiver& receiver, int size, double jitter, double longer, int frames,
                       std::uint64_t seed);

}  // namespace puckloop::framing
