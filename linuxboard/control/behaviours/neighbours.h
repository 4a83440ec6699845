#pragma once
// Who is around: one entry per robot heard lately, from the packets of the range-and-bearing board.
//
// A packet's lowest byte is the sender's id (as ARGoS's calibration has it), the bytes above are what its
// behaviour states. Strength scatters by 10 to 40 % from packet to packet, so it is averaged before it
// becomes a distance, and bearings are averaged as directions.

#include "linuxboard/control/behaviours/behaviour.h"
#include "linuxboard/control/rab/rab_board.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace puckloop::control {

inline constexpr int kIdBits = 8;
inline constexpr std::uint32_t kIdMask = (1U << kIdBits) - 1;

class Neighbourhood {
  public:
    /// `gain` as rab_range.h has it.
    explicit Neighbourhood(int own_id, double gain = 1) : own_id_(own_id), gain_(gain) {}

    /// Takes packets, forgets who was not heard for a second.
    void update(double now, std::span<const RabPacket> packets);
    /// In the order of their ids.
    std::vector<Neighbour> list(double now) const;
    /// "messages a second: 2: 31 (18 cm), 7: 12 (40 cm)", of the time since the last call; empty before a
    /// second has passed.
    std::string delivery(double now);

  private:
    struct Entry {
        std::uint32_t data = 0;
        double ahead = 0;  // averaged direction
        double left = 0;
        double strength = 0;
        double heard = 0;
    };

    int own_id_;
    double gain_;
    std::map<int, Entry> entries_;
    std::map<int, unsigned long> counts_;  // by id, since counted_from_
    double counted_from_ = -1;
};

}  // namespace puckloop::control
