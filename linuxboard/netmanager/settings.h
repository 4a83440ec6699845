#pragma once
// What the manager may be set to while it runs, and the words for it. One setting is one datagram at its
// control port, or one line of them:
//
//   range M | range none     largest distance of one hop
//   hops N                   most hops of a message
//   delay S                  a message is passed on so much later for each hop
//   loss P [FROM TO]         a message is lost with this chance, or one from FROM to TO
//   show                     nothing; as all others it is answered with the status

#include "linuxboard/netmanager/reach.h"

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace puckloop::netmanager {

struct Settings {
    Limits limits{};
    std::chrono::microseconds hop_delay{0};
    double loss = 0.0;                                     ///< 0 to 1
    std::map<std::pair<int, int>, double> loss_of_link{};  ///< from, to: in place of `loss`

    double loss_between(int from, int to) const {
        const auto known = loss_of_link.find({from, to});
        return known == loss_of_link.end() ? loss : known->second;
    }
};

inline constexpr double kFarthest = 1e6;       ///< m, of a range
inline constexpr double kLongestDelay = 60.0;  ///< s, of a hop

/// Carries out one line of words; what is wrong with it, or nothing.
std::string apply_words(std::string_view words, Settings& settings);

}  // namespace puckloop::netmanager
