#include "emu/radio/medium.h"

#include "emu/air/power.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::radio {

namespace {
constexpr double kCaptureDb = 3.0;
constexpr double kLossAtSensitivity = 0.01;
}  // namespace

double Propagation::received_dbm(double sent_dbm, double distance_m) const {
    return kSensitivityDbm + (sent_dbm - kFullPowerDbm) +
           air::fall(exponent, range_m / air::in_far_field(distance_m));
}

double Propagation::frame_loss(double dbm) const {
    // The range itself is within reach, whatever the last digit of a logarithm is.
    constexpr double kRounding = 1e-9;
    if (dbm < kSensitivityDbm - kRounding) return 1.0;
    const double noise = air::lost_in_noise(kLossAtSensitivity, std::max(0.0, dbm - kSensitivityDbm));
    return 1.0 - (1.0 - noise) * (1.0 - loss);
}

void Medium::forget_before(cosim::Time time) {
    on_air_.forget([time](const Transmission& one) { return one.end < time; });
}

double Medium::received_dbm(const Transmission& transmission, std::size_t receiver) const {
    if (transmission.foreign())
        return transmission.only.value_or(receiver) == receiver ? transmission.dbm
                                                                : -std::numeric_limits<double>::infinity();
    return propagation_.received_dbm(transmission.dbm,
                                     air::distance(positions_[transmission.station], positions_[receiver]));
}

Fate Medium::fate(const Transmission& transmission, std::size_t receiver,
                  const Transmission** foreign) const {
    const double dbm = received_dbm(transmission, receiver);
    if (propagation_.frame_loss(dbm) >= 1.0) return Fate::Weak;
    Fate found = Fate::Read;
    const Transmission* outsider = nullptr;
    bool by_module = false;
    on_air_.look_beside(transmission, [&](const Transmission& other) {
        if (other.channel != transmission.channel) return true;
        if (other.station == receiver) {
            found = Fate::Sending;
            return false;
        }
        // Two modules with one address acknowledge a frame with the same octets at the same time.
        if (other.answers != 0 && other.answers == transmission.answers) return true;
        if (received_dbm(other, receiver) <= dbm - kCaptureDb) return true;
        found = Fate::Collision;
        if (other.foreign())
            outsider = &other;
        else
            by_module = true;
        return true;
    });
    if (foreign != nullptr && found != Fate::Sending) *foreign = by_module ? nullptr : outsider;
    return found;
}

const Transmission* Medium::busy(std::size_t station, std::uint8_t channel, double threshold_dbm,
                                 cosim::Time now) const {
    const Transmission* found = nullptr;
    for (const Transmission& one : on_air_) {
        if (one.station == station || one.channel != channel || one.start > now || now >= one.end) continue;
        if (received_dbm(one, station) <= threshold_dbm) continue;
        found = &one;
        if (!one.foreign()) break;
    }
    return found;
}

cosim::Time Medium::own_until(std::size_t station, cosim::Time start, cosim::Time end) const {
    cosim::Time until = 0;
    for (const Transmission& one : on_air_)
        if (one.station == station && air::overlaps(one, start, end)) until = std::max(until, one.end);
    return until;
}

}  // namespace puckloop::radio
