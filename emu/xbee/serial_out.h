#pragma once
// DOUT of a module: its serial transmit buffer and baud-rate generator.
// Source: XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "Serial buffers", "Serial flow control", BD.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <algorithm>
#include <cstdint>
#include <deque>
#include <span>

namespace puckloop::xbee {

/// Bit time of a module set to BD: its clock of 16 MHz is divided by 16 and a whole number, so that 9600 is
/// 9615 baud and 115200 is 111111.
cosim::Time bit_period_of(std::uint32_t bd);

class SerialOut {
  public:
    /// The manual does not say how much fits; FT reaches 17 bytes less than this.
    static constexpr std::size_t kRoom = 255;
    static constexpr int kBitsToStop = 9, kBits = 10;

    /// All of `bytes` from `now` on, or nothing if they do not fit.
    bool put(std::span<const std::uint8_t> bytes, cosim::Time now);
    /// Holds further bytes back (RTS).
    void hold(bool held, cosim::Time now);
    /// From the next byte on, or after what is waiting. Announced before.
    void set_bit_period(cosim::Time period);
    void clear();

    /// When the next byte begins; kNever if none waits or they are held.
    cosim::Time next() const;
    cosim::Time bit_period() const { return bit_; }
    /// No byte that is still to begin has a shorter bit time.
    cosim::Time shortest_bit() const { return shortest_; }
    /// A change to this bit time is coming, not before nine of the present bits have passed.
    void announce_bit_period(cosim::Time period) { shortest_ = std::min(shortest_, period); }
    /// The byte that begins at next().
    cosim::UartFrame take();
    bool empty() const { return waiting_.empty(); }
    std::uint64_t sent() const { return sent_; }

  private:
    std::deque<std::uint8_t> waiting_;
    cosim::Time bit_ = 104 * cosim::kMicrosecond, wanted_bit_ = bit_, shortest_ = bit_;
    cosim::Time free_ = 0;  ///< the line is free from then on
    bool held_ = false;
    std::uint64_t sent_ = 0;
};

}  // namespace puckloop::xbee
