#include "emu/wifi/medium.h"

#include "emu/air/power.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::wifi {

using cosim::Time;

namespace {

constexpr double kNoiseOfSource = -91.0;  // dBm, for which sensitivities are stated
constexpr double kLostAtSensitivity = 0.1;
constexpr double kOctetsOfSource = 1000.0;
constexpr double kBodyRadius = 0.037;  // m
constexpr double kNeverLost = 1e-12;   // nothing is drawn for less

double milliwatts(double dbm) {
    return std::pow(10.0, dbm / 10.0);
}

/// Chance that a frame is lost which arrives so many dB above what it needs.
double loss(double margin, std::size_t octets) {
    const double of_source = std::min(1.0, air::lost_in_noise(kLostAtSensitivity, margin));
    return 1.0 - std::pow(1.0 - of_source, static_cast<double>(octets) / kOctetsOfSource);
}

}  // namespace

Medium::Medium(const WifiSettings& settings, std::vector<std::string> names, std::vector<Position> positions,
               std::uint64_t seed)
    : settings_(settings), positions_(std::move(positions)) {
    shadows_.assign(names.size(), std::vector<double>(names.size()));
    for (std::size_t a = 0; a < names.size(); ++a)
        for (std::size_t b = a + 1; b < names.size(); ++b) {
            // By their names: one station more changes nothing between the others.
            RandomStream random(seed, fmt::format("wifi shadow {} {}", std::min(names[a], names[b]),
                                                  std::max(names[a], names[b])));
            shadows_[a][b] = shadows_[b][a] = settings.shadowing * random.normal();
        }
}

/// dB: bodies across the line between the two.
double Medium::body_loss(std::size_t from, std::size_t to) const {
    if (settings_.body_loss == 0) return 0.0;
    const Position &a = positions_[from], &b = positions_[to];
    const double x = b[0] - a[0], y = b[1] - a[1], square = x * x + y * y;
    double loss = 0.0;
    for (const std::size_t body : bodies_) {
        if (body == from || body == to || square == 0) continue;
        const Position& at = positions_[body];
        const double along = ((at[0] - a[0]) * x + (at[1] - a[1]) * y) / square;  // 0 at a, 1 at b
        if (along <= 0 || along >= 1) continue;
        const double beside = std::hypot(a[0] + along * x - at[0], a[1] + along * y - at[1]);
        if (beside < kBodyRadius) loss += settings_.body_loss;
    }
    return loss;
}

double Medium::received_dbm(std::size_t from, std::size_t to) const {
    const double distance = air::in_far_field(air::distance(positions_[from], positions_[to]));
    return settings_.power - settings_.loss_at_1m - air::fall(settings_.exponent, distance) -
           shadows_[from][to] - body_loss(from, to) -
           obstacles_.loss_between(positions_[from], positions_[to]);
}

const Transmission& Medium::add(Transmission transmission) {
    transmission.dbm.resize(positions_.size());
    for (std::size_t to = 0; to < positions_.size(); ++to)
        transmission.dbm[to] = transmission.station == kInterference ? settings_.burst_power
                               : to == transmission.station          ? settings_.power
                                                                     : received_dbm(transmission.station, to);
    return on_air_.add(std::move(transmission));
}

Fate Medium::judge(const Transmission& transmission, std::size_t receiver, RandomStream& random) const {
    double disturbance = 0.0;
    bool sending = false;
    on_air_.look_beside(transmission, [&](const Transmission& other) {
        sending = other.station == receiver;
        disturbance += milliwatts(other.dbm[receiver]);
        return !sending;
    });
    if (sending) return Fate::Sending;
    const double noise = milliwatts(settings_.noise);
    const double needed = transmission.rate->sensitivity_dbm - kNoiseOfSource;  // above the noise, dB
    const auto loss_in = [&](double power) {
        return loss(transmission.dbm[receiver] - 10.0 * std::log10(power) - needed, transmission.octets);
    };
    if (loss_in(noise) >= 1.0) return Fate::Weak;
    const double lost = loss_in(noise + disturbance);
    const Fate if_lost = disturbance > noise ? Fate::Collision : Fate::Noise;
    if (lost >= 1.0) return if_lost;
    return lost > kNeverLost && random.uniform() < lost ? if_lost : Fate::Read;
}

void Medium::forget() {
    Time oldest = cosim::kNever;
    for (const Transmission& one : on_air_)
        if (!one.over) oldest = std::min(oldest, one.start);
    on_air_.forget([&](const Transmission& one) { return one.over && one.end <= oldest; });
}

}  // namespace puckloop::wifi
