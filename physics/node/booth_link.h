#pragma once
// The world's end of the link to a TAM's board: beams out, coloured LEDs in.

#include "cosim/core/message.h"
#include "physics/description/booth.h"

#include <array>
#include <cstdint>
#include <map>
#include <vector>

namespace puckloop::physics {

class BoothLink {
  public:
    BoothLink(const Booth& booth, cosim::PortIndex port);

    /// An LED of its board; other signals are ignored.
    void take(const cosim::Signal& signal, BoothModel& booth) const;
    /// Appends what has changed of the beams, stamped `time`.
    void publish(const BoothModel& booth, cosim::Time time, std::vector<cosim::Message>& outbox);

  private:
    struct Led {
        std::size_t light = 0, colour = 0;  // red, green, blue
    };
    cosim::PortIndex port_;
    std::map<std::uint16_t, Led> leds_;  // by signal id
    std::array<std::uint16_t, booth::kBarriers> barriers_;
    std::array<double, booth::kBarriers> last_{};  // as published; a board begins with free beams
};

}  // namespace puckloop::physics
