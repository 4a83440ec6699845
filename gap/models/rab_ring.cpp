#include "gap/models/rab_ring.h"

#include "base/random.h"
#include "gap/stats/tails.h"
#include "physics/description/parameters.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kHalfTurn = std::numbers::pi;
constexpr std::size_t kDraws = 24;     // a message; each with its mirror image, so that odd parts cancel
constexpr std::size_t kBoards = 48;    // pairs, drawn for what a run's own do
constexpr std::size_t kHeadings = 24;  // of a sender that nobody looked at
constexpr double kMillimetre = 1e-3;
constexpr double kLeastCosine = 1e-3;
constexpr double kFaintest = 1e-6;  // counts

double below(double z) {
    return stats::normal_tail(-z);
}

/// The firmware's table, degrees: not the receivers' true directions, which a board may have otherwise.
constexpr std::array<double, kRabParts> kTable{15, 50, 75, 105, 133, 159, -165, -135, -105, -77, -50, -15};

struct Direction {
    double angle, cosine, sine;
};
const std::array<Direction, kRabParts>& table() {
    static const auto directions = [] {
        std::array<Direction, kRabParts> all{};
        for (std::size_t k = 0; k < kRabParts; ++k) {
            const double angle = kTable[k] * kHalfTurn / 180;
            all[k] = {angle, std::cos(angle), std::sin(angle)};
        }
        return all;
    }();
    return directions;
}

/// How much of its strength a receiver at a bearing would read with the light ahead of it, by the firmware.
double log_ahead(double bearing, std::size_t sensor) {
    return -0.5 * std::log(std::max(std::abs(std::cos(bearing - table()[sensor].angle)), kLeastCosine));
}

/// Level and carrier at a receiver, emitters of these gains.
std::pair<double, double> light_at(const physics::IrCoupling& light, std::size_t receiver,
                                   const std::array<double, kRabParts>& gain) {
    double level = 0, carrier = 0;
    for (std::size_t e = 0; e < kRabParts; ++e) {
        level += gain[e] * static_cast<double>(light.level[e][receiver]);
        carrier += gain[e] * static_cast<double>(light.carrier[e][receiver]);
    }
    return {level, carrier};
}

/// The mean of the reading when each receiver's ln strength scatters by `spread`: which receiver is the
/// second best is chance then, and the better of two scattered ones is better than their means.
double mean_log_strength(const std::array<double, kRabParts>& peaks, double bearing, double spread) {
    std::array<std::size_t, kRabParts> order{};
    for (std::size_t k = 0; k < kRabParts; ++k)
        order[k] = k;
    std::partial_sort(order.begin(), order.begin() + 3, order.end(),
                      [&](std::size_t a, std::size_t b) { return peaks[a] > peaks[b]; });
    std::array<double, 3> level{}, lit{};
    for (std::size_t k = 0; k < 3; ++k) {
        level[k] = std::log(std::max(peaks[order[k]], kFaintest));
        lit[k] = level[k] + log_ahead(bearing, order[k]);
    }
    const double apart = spread * std::numbers::sqrt2;
    const double lead = (level[1] - level[2]) / apart;
    const double second = lit[2] + below(lead) * (lit[1] - lit[2]) +
                          apart * std::exp(-lead * lead / 2) / std::sqrt(2 * kHalfTurn);
    const double share = 1 / (1 + std::exp(4 * (lit[0] - second)));  // of the second in the sum
    return lit[0] - 0.25 * std::log(1 - share) + 4 * share * (1 - share) * spread * spread;
}

}  // namespace

RabReading rab_reading(const std::array<double, kRabParts>& peaks) {
    double x = 0, y = 0;
    std::size_t first = 0, second = 0;
    double first_peak = 0, second_peak = 0;
    for (std::size_t k = 0; k < kRabParts; ++k) {
        x += peaks[k] * table()[k].cosine;
        y += peaks[k] * table()[k].sine;
        if (peaks[k] > first_peak) {
            second = std::exchange(first, k);
            second_peak = std::exchange(first_peak, peaks[k]);
        } else if (peaks[k] > second_peak) {
            second = k;
            second_peak = peaks[k];
        }
    }
    if (first_peak <= 0) return {};
    RabReading read;
    read.bearing = std::atan2(y, x);
    const auto share = [&](double peak, std::size_t sensor) {
        return std::exp(4 * (std::log(peak) + log_ahead(read.bearing, sensor)));
    };
    read.log_strength =
        0.25 * std::log(share(first_peak, first) + (second_peak > 0 ? share(second_peak, second) : 0.0));
    return read;
}

RabRing::RabRing(std::vector<RabLook> looks, const physics::IrParameters& parameters, double carrier)
    : looks_(std::move(looks)),
      parameters_(parameters),
      carrier_(carrier > 0 ? carrier : parameters.centre_frequency) {
    draw_chance();
}

RabParts RabRing::neutral() const {
    RabParts parts;
    parts.receiver.fill(1.0);
    parts.emitter.fill(1.0);
    parts.emitter_lobe = parameters_.emitter_exponent;
    parts.receiver_lobe = parameters_.receiver_exponent;
    return parts;
}

double RabRing::full_scale(std::size_t receiver) const {
    return std::max(parameters_.rail - parameters_.baseline[receiver], 1.0);
}

/// Light of every look with lobes of these exponents, gains of all parts 1.
std::vector<RabRing::Light> RabRing::shine(double emitter_lobe, double receiver_lobe) const {
    auto p = parameters_;
    p.emitter_exponent = emitter_lobe;
    p.receiver_exponent = receiver_lobe;
    p.emitter_spread = p.receiver_spread = p.demodulator_spread = 0.0;  // they are chance here
    physics::IrBoard sender(p, 0, "sender"), receiver(p, 0, "receiver");
    const double bodies = 2 * physics::Parameters().robot.radius;
    std::vector<Light> all(looks_.size());
    for (std::size_t i = 0; i < looks_.size(); ++i) {
        const RabLook& look = looks_[i];
        const double apart = bodies + look.distance;
        const auto light_of = [&](double facing) {
            sender.place(apart * std::cos(look.bearing), apart * std::sin(look.bearing),
                         look.bearing + kHalfTurn - facing);
            Light light = physics::couple(sender, receiver, {1.0, carrier_}, {}, {});
            for (std::size_t e = 0; look.emitter != 0 && e < kRabParts; ++e)
                if (e + 1 != static_cast<std::size_t>(look.emitter)) light.level[e] = light.carrier[e] = {};
            return light;
        };
        if (!std::isnan(look.facing) || look.emitter != 0) {
            // Of a single emitter and an unknown heading: that it looked at the receiver.
            const auto number = static_cast<std::size_t>(std::max(look.emitter, 1)) - 1;
            all[i] = light_of(std::isnan(look.facing) ? p.emitter_angle[number] : look.facing);
            continue;
        }
        for (std::size_t h = 0; h < kHeadings; ++h) {
            const Light light = light_of(2 * kHalfTurn * static_cast<double>(h) / kHeadings);
            for (std::size_t e = 0; e < kRabParts; ++e)
                for (std::size_t k = 0; k < kRabParts; ++k) {
                    all[i].level[e][k] += light.level[e][k] / static_cast<float>(kHeadings);
                    all[i].carrier[e][k] += light.carrier[e][k] / static_cast<float>(kHeadings);
                }
        }
    }
    return all;
}

/// What reaches each receiver of each look, and whether it counts.
std::shared_ptr<const std::vector<RabRing::Seen>> RabRing::gather(const RabParts& parts) const {
    const std::vector<double> lobes{parts.emitter_lobe, parts.receiver_lobe};
    auto key = lobes;
    key.insert(key.end(), parts.emitter.begin(), parts.emitter.end());
    return seen_.get(key, [&] {
        const auto light = light_.get(lobes, [&] { return shine(parts.emitter_lobe, parts.receiver_lobe); });
        const double soft = std::hypot(parameters_.carrier_noise, parameters_.demodulator_spread);
        std::vector<Seen> all(looks_.size());
        for (std::size_t i = 0; i < looks_.size(); ++i)
            for (std::size_t k = 0; k < kRabParts; ++k) {
                const auto [level, carrier] = light_at((*light)[i], k, parts.emitter);
                all[i].level[k] = level;
                if (level <= 0 || carrier <= 0) continue;
                if (soft > 0)
                    all[i].heard[k] = below(std::log(carrier / parameters_.threshold) / soft);
                else
                    all[i].heard[k] = carrier >= parameters_.threshold ? 1.0 : 0.0;
            }
        return all;
    });
}

RabReading RabRing::reading_of(const Seen& seen, const RabParts& parts) const {
    std::array<double, kRabParts> peaks{};
    for (std::size_t k = 0; k < kRabParts; ++k)
        peaks[k] = seen.heard[k] * std::min(parts.receiver[k] * seen.level[k], full_scale(k));
    RabReading read = rab_reading(peaks);
    const double spread = std::hypot(parameters_.receiver_spread, parameters_.receiver_noise);
    if (spread > 0 && read.log_strength != 0)
        read.log_strength = mean_log_strength(peaks, read.bearing, spread);
    return read;
}

std::shared_ptr<const std::vector<RabReading>> RabRing::readings(const RabParts& parts) const {
    std::vector<double> key{parts.emitter_lobe, parts.receiver_lobe};
    key.insert(key.end(), parts.emitter.begin(), parts.emitter.end());
    key.insert(key.end(), parts.receiver.begin(), parts.receiver.end());
    return readings_.get(key, [&] {
        const auto seen = gather(parts);
        std::vector<RabReading> all(looks_.size());
        for (std::size_t i = 0; i < looks_.size(); ++i) {
            all[i] = reading_of((*seen)[i], parts);
            all[i].log_strength += shift_[i].log_strength;
            all[i].bearing += shift_[i].bearing;
        }
        return all;
    });
}

std::vector<std::vector<RabReading>> RabRing::drawn_boards() const {
    RandomStream random(1, "gap/rab boards");
    std::vector<std::vector<RabReading>> all;
    for (std::size_t board = 0; board < kBoards; ++board) {
        RabParts parts = neutral();
        for (std::size_t k = 0; k < kRabParts; ++k) {
            parts.emitter[k] = std::exp(parameters_.emitter_spread * random.normal());
            parts.receiver[k] = std::exp(parameters_.receiver_spread * random.normal());
        }
        all.push_back(*readings(parts));
    }
    for (std::size_t i = 0; i < looks_.size(); ++i) {
        RabReading mean;
        for (auto& board : all) {
            board[i].bearing = std::remainder(board[i].bearing - looks_[i].bearing, 2 * kHalfTurn);
            mean.log_strength += board[i].log_strength / kBoards;
            mean.bearing += board[i].bearing / kBoards;
        }
        for (auto& board : all) {
            board[i].log_strength -= mean.log_strength;
            board[i].bearing -= mean.bearing;
        }
    }
    return all;
}

/// As IrMedium::draw_noise and IrBoard draw it; parts anew for every message.
void RabRing::draw_chance() {
    const RabParts plain = neutral();
    const auto seen = gather(plain);
    const auto all_light = shine(plain.emitter_lobe, plain.receiver_lobe);
    const auto& p = parameters_;
    RandomStream random(1, "gap/rab ring");
    struct Sum {
        double n = 0, strength = 0, bearing = 0;  // squares
    };
    std::map<std::pair<long, bool>, Sum> sums;
    const auto group = [](const RabLook& look) {
        return std::pair(std::lround(look.distance / kMillimetre), look.emitter != 0);
    };
    shift_.assign(looks_.size(), {});
    std::array<double, kRabParts> emitter{}, receiver{}, demodulator{};
    for (std::size_t i = 0; i < looks_.size(); ++i) {
        const RabReading plainly = reading_of((*seen)[i], plain);
        const double near = p.near_noise * std::exp(-std::max(looks_[i].distance, 0.0) / p.near_range);
        double n = 0;
        Sum sum;
        for (std::size_t draw = 0; draw < kDraws; ++draw) {
            const double common = std::hypot(p.frame_noise, near) * random.normal();
            for (std::size_t k = 0; k < kRabParts; ++k) {
                emitter[k] = p.emitter_spread * random.normal();
                receiver[k] = common + std::hypot(p.receiver_spread, p.receiver_noise) * random.normal();
                demodulator[k] = std::hypot(p.demodulator_spread, p.carrier_noise) * random.normal();
            }
            for (const double sign : {1.0, -1.0}) {
                std::array<double, kRabParts> gain{}, peaks{};
                for (std::size_t e = 0; e < kRabParts; ++e)
                    gain[e] = std::exp(sign * emitter[e]);
                for (std::size_t k = 0; k < kRabParts; ++k) {
                    const auto [level, carrier] = light_at(all_light[i], k, gain);
                    if (carrier * std::exp(sign * demodulator[k]) < p.threshold) continue;
                    peaks[k] =
                        std::min(std::max(level, kFaintest) * std::exp(sign * receiver[k]), full_scale(k));
                }
                if (*std::ranges::max_element(peaks) <= 0) continue;
                const RabReading read = rab_reading(peaks);
                const double strength = read.log_strength - plainly.log_strength;
                const double bearing = std::remainder(read.bearing - plainly.bearing, 2 * kHalfTurn);
                ++n;
                shift_[i].log_strength += strength;
                shift_[i].bearing += bearing;
                sum.strength += strength * strength;
                sum.bearing += bearing * bearing;
            }
        }
        if (n == 0) continue;
        shift_[i].log_strength /= n;
        shift_[i].bearing /= n;
        Sum& all = sums[group(looks_[i])];
        all.n += n;
        all.strength += sum.strength - n * shift_[i].log_strength * shift_[i].log_strength;
        all.bearing += sum.bearing - n * shift_[i].bearing * shift_[i].bearing;
    }
    for (const RabLook& look : looks_) {
        const Sum& all = sums[group(look)];
        const double count = std::max(all.n, 1.0);
        strength_sd_.push_back(std::sqrt(std::max(all.strength / count, kFaintest)));
        bearing_sd_.push_back(std::sqrt(std::max(all.bearing / count, kFaintest)));
    }
}

}  // namespace puckloop::gap
