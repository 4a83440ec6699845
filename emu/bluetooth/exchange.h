#pragma once
// Whole exchanges between two modules, host and all, as in the published experiment: a sender's host looks
// for e-pucks, asks their names, links with the one that it wants, sends a word, releases. The receiver's
// module is in automatic mode and becomes transparent. The sender's host sends what the e-puck library sends.

#include "emu/bluetooth/times.h"

#include <cstdint>

namespace puckloop::bluetooth {

/// One exchange, s. Times are of the parts as the host sees them.
struct Exchange {
    bool found = false;  ///< in the inquiry
    bool linked = false;
    bool arrived = false;  ///< every byte of the word
    double inquiry = 0.0, name = 0.0, link = 0.0, release = 0.0;
    double total = 0.0;  ///< from the first request to the release, or to the failure
};

/// Exchange number `number` of a seed, from power-up; any of them can be had without the others.
Exchange exchange(const Times& times, std::uint64_t seed, std::uint64_t number);

}  // namespace puckloop::bluetooth
