#pragma once
// The air at 2.4 GHz: who receives which transmission how strongly, and what keeps it from being read.
// Sources: XBee/XBee-PRO DigiMesh 2.4 manual (90000991), "Specifications" (indoor range 30 m, receiver -92
// dBm at 1 % packet errors); IEEE 802.15.4-2006, section 6.5 and annex E.
//
// Deviations:
// 1. Power falls with one exponent (indoors 3 to 4) from the range on, where it is the sensitivity; no walls,
//    no fading. With the default values it agrees with free space at 1 m within 2 dB.
// 2. A frame is lost in noise with 1 % at the sensitivity and a tenth of it for each dB more.
// 3. Against others on the channel a frame is read if it is 3 dB stronger than each that overlaps it
//    anywhere (co-channel rejection of such receivers), else not. Channels do not disturb one another.

#include "base/fields/field.h"
#include "cosim/core/time.h"
#include "emu/air/fate.h"
#include "emu/air/on_air.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::radio {

struct Propagation {
    double range_m = 30.0;
    double exponent = 3.5;
    double loss = 0.0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("range_m", &Propagation::range_m,
                           "distance at which a frame sent with full power arrives at the sensitivity")
                         .in("m")
                         .above(0),
                     field("exponent", &Propagation::exponent, "of distance, by which power falls").above(0),
                     field("loss", &Propagation::loss, "share of frames that other users of the band spoil")
                         .within(0, 1));
    }

    /// Received power over a distance in metres.
    double received_dbm(double sent_dbm, double distance_m) const;
    /// Probability that a frame that arrives with this power is not read; 1 below the sensitivity.
    double frame_loss(double dbm) const;
};
static_assert(lists_all_fields<Propagation>);

inline constexpr double kSensitivityDbm = -92.0;
inline constexpr double kFullPowerDbm = 1.42;  ///< PL = 4

using Position = std::array<double, 3>;  ///< metres

/// Stations from here on are of foreign networks (a fault); all receive them with the power they send with.
inline constexpr std::size_t kForeignStation = 1'000'000;

/// One frame on air.
struct Transmission {
    std::uint64_t id = 0;
    std::size_t station = 0;
    std::uint8_t channel = 0;
    double dbm = 0.0;
    cosim::Time start = 0, end = 0;
    std::uint64_t answers = 0;          ///< an acknowledgement: id of the frame that it is for, else 0
    std::optional<std::size_t> only{};  ///< of a foreign network: who alone receives it

    bool foreign() const { return station >= kForeignStation; }
};

using air::Fate;

class Medium {
  public:
    Medium(const Propagation& propagation, std::vector<Position> positions)
        : propagation_(propagation), positions_(std::move(positions)) {}

    void add(const Transmission& transmission) { on_air_.add(transmission); }
    /// Transmissions that ended before `time` are forgotten.
    void forget_before(cosim::Time time);

    double received_dbm(const Transmission& transmission, std::size_t receiver) const;
    /// To be asked when the transmission ends, of all but noise. `foreign`: the foreign frame that alone
    /// makes the collision.
    Fate fate(const Transmission& transmission, std::size_t receiver,
              const Transmission** foreign = nullptr) const;
    /// Something on the channel that is stronger than `threshold_dbm` at the station, a module's first.
    const Transmission* busy(std::size_t station, std::uint8_t channel, double threshold_dbm,
                             cosim::Time now) const;
    /// End of the station's own transmission that overlaps [start, end), or 0.
    cosim::Time own_until(std::size_t station, cosim::Time start, cosim::Time end) const;
    const Propagation& propagation() const { return propagation_; }

  private:
    Propagation propagation_;
    std::vector<Position> positions_;
    air::OnAir<Transmission> on_air_;
};

}  // namespace puckloop::radio
