#pragma once
// The air of a wireless network: who receives which frame how strongly, and what keeps it from being read.
// Source: IEEE 802.11-2016, table 17-18 (sensitivity at 10 % of frames lost, noise figure 10 dB, 5 dB for the
// implementation).
//
// Deviations:
// 1. Power falls with one exponent of distance; what differs from that is drawn once for each pair of
//    stations and stays, however they move. No fading. Bodies are the stations' that are robots, discs of
//    7.4 cm; one is in the way where the line between two stations' centres crosses it. Walls: obstacles.h.
// 2. A frame of 1000 octets is lost with 10 % at the sensitivity, a tenth of it with each dB more.
// 3. Other frames add to the noise, over the whole frame and each in full, whenever they overlap it; a
//    receiver locks on to no weaker frame first.
// 4. One channel. What disturbs it from outside are bursts of noise with one power everywhere.

#include "base/random.h"
#include "cosim/core/octets.h"
#include "emu/air/fate.h"
#include "emu/air/on_air.h"
#include "emu/wifi/obstacles.h"
#include "emu/wifi/phy.h"

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::wifi {

inline constexpr std::size_t kEveryStation = ~std::size_t{0};
/// In place of a station: a burst of noise from outside.
inline constexpr std::size_t kInterference = kEveryStation - 1;

/// A packet as stations hand it to each other.
struct Frame {
    std::uint64_t number = 0;  ///< of the packet in the run; once more with each station that passes it on
    std::size_t from = 0;      ///< computer that it is from
    std::size_t hop_to = 0;    ///< station, or kEveryStation
    std::size_t to = 0;        ///< in a mesh: station that it is for, or kEveryStation
    std::int64_t hops = 0;     ///< in a mesh: that it has gone
    cosim::Octets octets{};
};

/// One frame on air.
struct Transmission {
    std::uint64_t id = 0;
    std::size_t station = 0;
    cosim::Time start = 0, end = 0;
    const Rate* rate = nullptr;
    std::size_t octets = 0;     ///< with header and check
    bool acknowledges = false;  ///< it is an acknowledgement for `hop_to`
    std::size_t hop_to = 0;
    std::int64_t attempt = 1;
    cosim::Time reserved = 0;   ///< the channel is taken until then, as its header has it
    std::vector<double> dbm{};  ///< at each station
    bool over = false;          ///< it has ended, and is kept for those that it overlaps
};

using air::Fate;
using air::Losses;

class Medium {
  public:
    /// `names`: of the stations, for what is drawn.
    Medium(const WifiSettings& settings, std::vector<std::string> names, std::vector<Position> positions,
           std::uint64_t seed);

    void move(std::size_t station, const Position& to) { positions_[station] = to; }
    const Position& position(std::size_t station) const { return positions_[station]; }
    /// What stands between stations; at first nothing does.
    void set_obstacles(Obstacles obstacles) { obstacles_ = std::move(obstacles); }
    Obstacles& obstacles() { return obstacles_; }
    /// The station is on a robot, whose body is in the way of others.
    void embody(std::size_t station) { bodies_.push_back(station); }
    /// What a station receives of another one, in dBm.
    double received_dbm(std::size_t from, std::size_t to) const;
    /// Sets `dbm` of the transmission, and keeps it. `station` may be kInterference.
    const Transmission& add(Transmission transmission);
    /// To be asked when it ends. `random`: the receiver's.
    Fate judge(const Transmission& transmission, std::size_t receiver, RandomStream& random) const;
    /// Those that are over are forgotten, unless they overlap one that is not.
    void forget();
    air::OnAir<Transmission>& on_air() { return on_air_; }
    const air::OnAir<Transmission>& on_air() const { return on_air_; }

  private:
    WifiSettings settings_;
    double body_loss(std::size_t from, std::size_t to) const;

    std::vector<Position> positions_;
    std::vector<std::size_t> bodies_;
    Obstacles obstacles_{{}, -1, 0.0};
    std::vector<std::vector<double>> shadows_;  ///< dB, of each pair
    air::OnAir<Transmission> on_air_;           ///< in the order in which they began
};

}  // namespace puckloop::wifi
