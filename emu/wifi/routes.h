#pragma once
// Ways through a wireless mesh: which station hands a frame on to which, so that all of it takes the least
// time on the air. Source: IEEE 802.11-2016, 14.9 (airtime link metric: overhead and bits over the rate, for
// 8192 bits).
//
// Deviations: 1. Ways are as a link-state protocol has them that knows every link by its power at the time of
// the update; finding them takes no frames. 2. The metric counts no frame errors: a link whose power is no
// 3 dB above the slowest rate's sensitivity is none.

#include "emu/wifi/dcf.h"

#include <cstddef>
#include <vector>

namespace puckloop::wifi {

class Routes {
  public:
    static constexpr std::size_t kNoWay = ~std::size_t{0};

    /// Ways have `most` hops at most.
    Routes(std::size_t stations, std::int64_t most);

    struct Change {
        std::size_t from = 0, to = 0;
        std::size_t next = kNoWay;  ///< station
        std::size_t hops = 0;       ///< 0: there is no way
    };
    /// As the powers are now. What is other than before, by `from` and then `to`.
    std::vector<Change> update(const Dcf& dcf);

    std::size_t next(std::size_t from, std::size_t to) const { return ways_[from][to].next; }
    std::size_t hops(std::size_t from, std::size_t to) const { return ways_[from][to].hops; }

  private:
    struct Way {
        std::size_t next = kNoWay;
        std::size_t hops = 0;
        friend bool operator==(const Way&, const Way&) = default;
    };
    std::vector<Way> ways_from(std::size_t from, const std::vector<std::vector<cosim::Time>>& costs) const;

    std::int64_t most_;
    std::vector<std::vector<Way>> ways_;
};

}  // namespace puckloop::wifi
