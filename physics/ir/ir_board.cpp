// One board of the infra-red medium: parts with their spread, power, band pass, strength curve.

#include "base/random.h"
#include "physics/ir/ir_coupling.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace puckloop::physics {

namespace {

constexpr double kFullByte = 255;
constexpr double kFaintestPeak = 1e-3;  // counts; keeps the curve's logarithm finite

IrArray<double> spread(std::uint64_t seed, const std::string& stream, double sigma) {
    RandomStream random(seed, stream);
    IrArray<double> factors{};
    for (double& factor : factors)
        factor = std::exp(sigma * random.normal());
    return factors;
}

/// Share of full current.
double emitter_current(const IrParameters& p, double potentiometer) {
    const double open = std::clamp(1.0 - potentiometer / kFullByte, 0.0, 1.0);
    return p.power_floor + (1.0 - p.power_floor) * std::pow(open, p.power_exponent);
}

}  // namespace

IrBoard::IrBoard(const IrParameters& parameters, std::uint64_t seed, std::string_view name)
    : parameters_(parameters) {
    const std::string stream = "ir/" + std::string(name);
    const auto emitter = spread(seed, stream + "/emitters", parameters.emitter_spread);
    const auto receiver = spread(seed, stream + "/receivers", parameters.receiver_spread);
    const auto demodulator = spread(seed, stream + "/demodulators", parameters.demodulator_spread);
    const auto part = [&](double angle, double gain, double demodulation) {
        const double dx = std::cos(angle);
        const double dy = std::sin(angle);
        return Part{parameters.ring * dx, parameters.ring * dy, dx, dy, gain, demodulation};
    };
    for (std::size_t i = 0; i < kIrSensors; ++i) {
        own_emitters_[i] = part(parameters.emitter_angle[i], parameters.emitter_gain[i] * emitter[i], 1.0);
        own_receivers_[i] = part(parameters.receiver_angle[i], parameters.receiver_gain[i] * receiver[i],
                                 parameters.demodulator_gain[i] * demodulator[i]);
    }
    for (std::size_t i = 0; i < kIrCurvePoints; ++i)
        log_level_[i] = std::log(std::max(parameters.level[i], kFaintestPeak));
    place(0, 0, 0);
}

void IrBoard::place(double x, double y, double heading) {
    x_ = x;
    y_ = y;
    heading_ = heading;
    const double cosine = std::cos(heading);
    const double sine = std::sin(heading);
    const auto put = [&](const Part& own) {
        Part part = own;
        part.x = x + cosine * own.x - sine * own.y;
        part.y = y + sine * own.x + cosine * own.y;
        part.dx = cosine * own.dx - sine * own.dy;
        part.dy = sine * own.dx + cosine * own.dy;
        return part;
    };
    std::transform(own_emitters_.begin(), own_emitters_.end(), emitters_.begin(), put);
    std::transform(own_receivers_.begin(), own_receivers_.end(), receivers_.begin(), put);
}

double IrBoard::power(double potentiometer) const {
    const double reference = emitter_current(parameters_, parameters_.power_reference);
    return reference > 0.0 ? emitter_current(parameters_, potentiometer) / reference : 0.0;
}

double IrBoard::response(double hertz) const {
    if (hertz <= 0.0) return 0.0;
    const double ratio = hertz / parameters_.centre_frequency;
    return 1.0 / std::hypot(1.0, parameters_.quality * (ratio - 1.0 / ratio));
}

double IrBoard::level(double metres) const {
    const auto& at = parameters_.distance;
    const auto after = std::upper_bound(at.begin(), at.end(), metres);
    if (after == at.begin()) return parameters_.level.front();
    if (after == at.end()) {
        const double shorter = (at.back() + parameters_.source_offset) / (metres + parameters_.source_offset);
        return parameters_.level.back() * shorter * shorter;
    }
    const auto i = static_cast<std::size_t>(after - at.begin());
    const double share = (metres - at[i - 1]) / (at[i] - at[i - 1]);
    return std::exp(log_level_[i - 1] + share * (log_level_[i] - log_level_[i - 1]));
}

}  // namespace puckloop::physics
