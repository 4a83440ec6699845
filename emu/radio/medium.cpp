#include "emu/radio/medium.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::radio {

namespace {
constexpr double kNearest = 0.1;  // m: closer, the far field's law does not hold
constexpr double kCaptureDb = 3.0;
constexpr double kLossAtSensitivity = 0.01;
}  // namespace

double distance(const Position& a, const Position& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

double Propagation::received_dbm(double sent_dbm, double distance_m) const {
    constexpr double kTenfold = 10.0;  // dB
    return kSensitivityDbm + (sent_dbm - kFullPowerDbm) +
           kTenfold * exponent * std::log10(range_m / std::max(distance_m, kNearest));
}

double Propagation::frame_loss(double dbm) const {
    // The range itself is within reach, whatever the last digit of a logarithm is.
    constexpr double kRounding = 1e-9;
    if (dbm < kSensitivityDbm - kRounding) return 1.0;
    const double noise = kLossAtSensitivity * std::pow(10.0, std::min(0.0, kSensitivityDbm - dbm));
    return 1.0 - (1.0 - noise) * (1.0 - loss);
}

void Medium::forget_before(cosim::Time time) {
    std::erase_if(on_air_, [time](const Transmission& one) { return one.end < time; });
}

double Medium::received_dbm(const Transmission& transmission, std::size_t receiver) const {
    if (transmission.foreign())
        return transmission.only.value_or(receiver) == receiver ? transmission.dbm
                                                                : -std::numeric_limits<double>::infinity();
    return propagation_.received_dbm(transmission.dbm,
                                     distance(positions_[transmission.station], positions_[receiver]));
}

Obstacle Medium::obstacle(const Transmission& transmission, std::size_t receiver,
                          const Transmission** foreign) const {
    const double dbm = received_dbm(transmission, receiver);
    if (propagation_.frame_loss(dbm) >= 1.0) return Obstacle::Weak;
    Obstacle found = Obstacle::None;
    const Transmission* outsider = nullptr;
    bool by_module = false;
    for (const Transmission& other : on_air_) {
        if (other.id == transmission.id || other.channel != transmission.channel) continue;
        if (other.end <= transmission.start || other.start >= transmission.end) continue;
        if (other.station == receiver) return Obstacle::Busy;
        // Two modules with one address acknowledge a frame with the same octets at the same time.
        if (other.answers != 0 && other.answers == transmission.answers) continue;
        if (received_dbm(other, receiver) <= dbm - kCaptureDb) continue;
        found = Obstacle::Collision;
        if (other.foreign())
            outsider = &other;
        else
            by_module = true;
    }
    if (foreign != nullptr) *foreign = by_module ? nullptr : outsider;
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
        if (one.station == station && one.start < end && start < one.end) until = std::max(until, one.end);
    return until;
}

}  // namespace puckloop::radio
