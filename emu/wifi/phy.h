#pragma once
// 802.11b and 802.11g on air: rates, times of frames, gaps and slots.
// Source: IEEE 802.11-2016, clauses 15 and 16 (DSSS, high rate), 17 and 18 (OFDM, ERP), 10.3 (gaps).
//
// Deviations: 1. All stations have one standard: no protection of 802.11g against 802.11b. 2. Short slots
// with 802.11g. 3. Sensitivity is the least that the standard asks for; 1 Mbit/s, for which it has none, is
// as 2 Mbit/s.

#include "cosim/core/time.h"
#include "emu/wifi/wifi_settings.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string>

namespace puckloop::wifi {

struct Rate {
    double bits = 0;             ///< a second
    double sensitivity_dbm = 0;  ///< 1000 octets arrive with an error in 10 of 100 frames
    int symbol_bits = 0;         ///< data bits of an OFDM symbol; 0: none
    bool basic = false;          ///< acknowledgements are sent with it
};

/// Header and check of a data frame, and of what is in it (LLC, SNAP).
inline constexpr std::size_t kFrameOctets = 24 + 4 + 8;
inline constexpr std::size_t kAckOctets = 14;

/// Why settings cannot be, and what might.
struct SettingsProblem {
    std::string key, problem, expected;
};
/// Beyond the ranges of single fields.
std::optional<SettingsProblem> problem_of(const WifiSettings& settings);

class Phy {
  public:
    /// Throws InputError for settings that cannot be.
    explicit Phy(const WifiSettings& settings);

    /// From the slowest to the fastest.
    std::span<const Rate> rates() const { return rates_; }
    const Rate& slowest() const { return rates_.front(); }
    /// The one with so many bits a second, which problem_of() knows.
    const Rate& rate_of(double bits) const;
    /// Of the acknowledgement of a frame with this rate: the fastest basic one that is no faster.
    const Rate& ack_rate(const Rate& rate) const;

    /// Of a frame, preamble to its end. `octets`: with header and check.
    cosim::Time air_time(std::size_t octets, const Rate& rate) const;
    /// What any packet takes at least.
    cosim::Time shortest_packet() const;

    cosim::Time slot() const { return slot_; }
    cosim::Time sifs() const { return sifs_; }
    cosim::Time difs() const { return sifs_ + 2 * slot_; }
    /// After a frame that could not be read.
    cosim::Time eifs() const { return sifs_ + air_time(kAckOctets, slowest()) + difs(); }
    /// A channel that becomes busy is noticed so much later.
    cosim::Time sensing() const { return sensing_; }
    /// After the end of a frame, until its acknowledgement must have begun.
    cosim::Time ack_wait() const { return sifs_ + slot_ + preamble_; }
    std::int64_t first_window() const { return first_window_; }

  private:
    std::span<const Rate> rates_;
    cosim::Time slot_ = 0, sifs_ = 0, sensing_ = 0, preamble_ = 0;
    std::int64_t first_window_ = 0;
};

}  // namespace puckloop::wifi
