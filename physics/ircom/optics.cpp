#include "physics/ircom/optics.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kTouching = 1e-9;  // m

/// Amplitude between two robots face to face, by the distance of their centres: e-puck fact sheet 3.10. The
/// last point, 10 counts at 22.5 cm, is the receiver's threshold and no measurement.
constexpr double kFirst = 0.075, kTableStep = 0.005;  // m
constexpr std::array kAmplitude{3533.795, 2103.529, 1135.429, 701.817, 508.598, 375.808, 305.284, 264.408,
                                206.877,  167.442,  137.039,  113.265, 91.575,  79.199,  69.404,  66.090,
                                51.444,   44.032,   38.548,   34.990,  31.674,  27.999,  25.922,  23.381,
                                21.986,   20.040,   18.303,   17.134,  16.112,  14.560};
/// Between the fronts of two robots face to face, of the way between their centres.
constexpr double kBetweenSensors = 0.062;
constexpr double kHighestCount = 8000;  // counts, at contact
constexpr int kRounds = 8;

/// Logarithms of the level of one diode, at kFirst + i * kTableStep - kBetweenSensors.
using Curve = std::array<double, kAmplitude.size()>;

double at(const Curve& curve, double metres) {
    const double place = (metres + kBetweenSensors - kFirst) / kTableStep;
    const auto last = static_cast<double>(curve.size() - 2);
    const double below = std::clamp(std::floor(place), 0.0, last);
    const auto i = static_cast<std::size_t>(below);
    return std::min(std::exp(curve[i] + (place - below) * (curve[i + 1] - curve[i])), kHighestCount);
}

double lobe(double cosine, double exponent) {
    if (exponent == 1.0) return cosine;
    if (exponent == 2.0) return cosine * cosine;
    return std::pow(cosine, exponent);
}

double counts(const Curve& curve, const IrcomPart& from, const IrcomPart& to, const IrcomParameters& p) {
    const double x = to.x - from.x;
    const double y = to.y - from.y;
    const double way = std::hypot(x, y);
    if (way > p.reach) return 0.0;
    if (way < kTouching) return kHighestCount;
    const double out = (x * from.dx + y * from.dy) / way;
    const double in = -(x * to.dx + y * to.dy) / way;
    if (out <= 0.0 || in <= 0.0) return 0.0;
    return at(curve, way) * lobe(out, p.emitter_exponent) * lobe(in, p.receiver_exponent);
}

/// The brightest sensor of a robot that faces another at `distance`.
double face_to_face(const Curve& curve, double distance, const Parameters& p) {
    const auto parts = ircom_parts(p.proximity);
    double brightest = 0.0;
    for (const IrcomPart& own : parts) {
        const IrcomPart receiver = in_world(own, distance, 0.0, -1.0, 0.0);
        double sum = 0.0;
        for (const IrcomPart& emitter : parts)
            sum += counts(curve, emitter, receiver, p.ircom);
        brightest = std::max(brightest, sum);
    }
    return brightest;
}

/// Found by repetition, with the parameters' defaults: what is wrong of the sum is put right in the curve.
Curve calibrated() {
    const Parameters defaults;
    Curve curve{};
    for (std::size_t i = 0; i < curve.size(); ++i)
        curve[i] = std::log(kAmplitude[i]);
    for (int round = 0; round < kRounds; ++round) {
        Curve better = curve;
        for (std::size_t i = 0; i < curve.size(); ++i) {
            const double distance = kFirst + static_cast<double>(i) * kTableStep;
            better[i] += std::log(kAmplitude[i] / face_to_face(curve, distance, defaults));
        }
        for (std::size_t i = 1; i < curve.size(); ++i)  // the measurement is not quite smooth
            better[i] = std::min(better[i], better[i - 1]);
        curve = better;
    }
    return curve;
}

const Curve& curve() {
    static const Curve kCurve = calibrated();
    return kCurve;
}

}  // namespace

IrcomPart in_world(const IrcomPart& own, double x, double y, double cosine, double sine) {
    return {x + cosine * own.x - sine * own.y, y + sine * own.x + cosine * own.y,
            cosine * own.dx - sine * own.dy, sine * own.dx + cosine * own.dy};
}

std::array<IrcomPart, kProximitySensors> ircom_parts(const ProximityParameters& parameters) {
    std::array<IrcomPart, kProximitySensors> parts;
    for (std::size_t i = 0; i < parts.size(); ++i)
        parts[i] = {parameters.x[i], parameters.y[i], std::cos(parameters.direction[i]),
                    std::sin(parameters.direction[i])};
    return parts;
}

double ircom_level(double metres) {
    return at(curve(), metres);
}

double ircom_counts(const IrcomPart& from, const IrcomPart& to, const IrcomParameters& parameters) {
    return counts(curve(), from, to, parameters);
}

bool ircom_shaded(const IrcomPart& from, const IrcomPart& to, std::span<const Shape* const> shapes) {
    const double x = to.x - from.x;
    const double y = to.y - from.y;
    const double way = std::hypot(x, y);
    if (way < kTouching) return false;
    return std::any_of(shapes.begin(), shapes.end(), [&](const Shape* shape) {
        const auto hit = chord(*shape, from.x, from.y, x / way, y / way);
        return hit && hit->out > kTouching && hit->in < way - kTouching;
    });
}

}  // namespace puckloop::physics
