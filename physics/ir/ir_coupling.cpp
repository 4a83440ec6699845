#include "physics/ir/ir_coupling.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kTouchingBoards = 1e-9;  // m

// A board that sends with all emitters is seen as the sum of their lobes, 12/pi for cosine lobes. The carrier
// is counted in boards, not in emitters. The range register is 2^(1/4) times the strength at two receivers
// that face the sender; with this the curve reads as the register does.
constexpr double kEmittersSeen = kIrSensors / std::numbers::pi;
const double kRegisterPerLevel = std::pow(2.0, 0.25);

double board_lobe(double cosine, double exponent) {
    if (cosine <= 0.0) return 0.0;
    if (exponent == 1.0) return cosine;
    if (exponent == 0.5) return std::sqrt(cosine);
    return std::pow(cosine, exponent);
}

/// Does anything stand on the way from `from` along (dx, dy) before `length`?
bool shaded(std::span<const Shape* const> shapes, const Point& from, double dx, double dy, double length,
            const Shape* except = nullptr) {
    return std::any_of(shapes.begin(), shapes.end(), [&](const Shape* shape) {
        if (shape == except) return false;
        const auto hit = chord(*shape, from.x, from.y, dx, dy);
        return hit && hit->out > kTouchingBoards && hit->in < length - kTouchingBoards;
    });
}

/// One face of a box: where a mirror image stands behind it.
struct Face {
    double x, y, normal_x, normal_y, half;
};

std::array<Face, 4> faces_of(const Shape& s) {
    const auto face = [&](double normal_x, double normal_y, double out, double half) {
        return Face{s.x + normal_x * out, s.y + normal_y * out, normal_x, normal_y, half};
    };
    return {face(s.cosine, s.sine, s.half_length, s.half_width),
            face(-s.cosine, -s.sine, s.half_length, s.half_width),
            face(-s.sine, s.cosine, s.half_width, s.half_length),
            face(s.sine, -s.cosine, s.half_width, s.half_length)};
}

class Coupler {
  public:
    Coupler(const IrBoard& sender, const IrBoard& receiver, const IrDrive& drive,
            std::span<const Shape* const> shapes)
        : sender_(sender),
          receiver_(receiver),
          shapes_(shapes),
          tx_(sender.parameters()),
          rx_(receiver.parameters()),
          power_(drive.power),
          carrier_scale_(drive.power * receiver.response(drive.carrier_hz) / kEmittersSeen),
          level_scale_(1.0 / (kEmittersSeen * kRegisterPerLevel)) {}

    void direct() {
        for (std::size_t e = 0; e < kIrSensors; ++e)
            for (std::size_t k = 0; k < kIrSensors; ++k)
                direct(e, k);
    }
    /// Every own receiver sees every own emitter as if over a path on which the carrier has that strength.
    void own() {
        if (rx_.self_coupling <= 0.0) return;
        const double path = (rx_.reach + rx_.source_offset) / std::sqrt(rx_.self_coupling * kEmittersSeen);
        for (std::size_t e = 0; e < kIrSensors; ++e)
            for (std::size_t k = 0; k < kIrSensors; ++k)
                add(e, k, 1.0, 1.0, path - rx_.source_offset, 1.0);
    }
    void mirrored(const Shape& shape) {
        const double share = rx_.reflection * shape.reflectivity;
        const bool high = shape.height > std::min(tx_.height, rx_.height);
        if (share <= 0.0 || shape.kind != Shape::Kind::Box || !high) return;
        for (const Face& face : faces_of(shape))
            for (std::size_t e = 0; e < kIrSensors; ++e)
                for (std::size_t k = 0; k < kIrSensors; ++k)
                    mirrored(e, k, shape, face, std::min(share, 1.0));
    }
    IrCoupling result;

  private:
    void direct(std::size_t e, std::size_t k) {
        const auto& from = sender_.emitters()[e];
        const auto& to = receiver_.receivers()[k];
        const double x = to.x - from.x;
        const double y = to.y - from.y;
        const double path = std::hypot(x, y);
        if (path < kTouchingBoards) return add(e, k, 1.0, 1.0, 0.0, 1.0);
        const double dx = x / path;
        const double dy = y / path;
        const double out = dx * from.dx + dy * from.dy;
        const double in = -dx * to.dx - dy * to.dy;
        if (out <= 0.0 || in <= 0.0 || shaded(shapes_, {from.x, from.y}, dx, dy, path)) return;
        add(e, k, out, in, path, 1.0);
    }

    /// The emitter's image behind the face; light goes to the face and on to the receiver.
    void mirrored(std::size_t e, std::size_t k, const Shape& shape, const Face& face, double share) {
        const auto& from = sender_.emitters()[e];
        const auto& to = receiver_.receivers()[k];
        const double before = (from.x - face.x) * face.normal_x + (from.y - face.y) * face.normal_y;
        const double after = (to.x - face.x) * face.normal_x + (to.y - face.y) * face.normal_y;
        if (before <= 0.0 || after <= 0.0) return;
        const Point image{from.x - 2 * before * face.normal_x, from.y - 2 * before * face.normal_y};
        const double x = to.x - image.x;
        const double y = to.y - image.y;
        const double path = std::hypot(x, y);
        const double dx = x / path;
        const double dy = y / path;
        const double lean = from.dx * face.normal_x + from.dy * face.normal_y;
        const double out =
            dx * (from.dx - 2 * lean * face.normal_x) + dy * (from.dy - 2 * lean * face.normal_y);
        const double in = -dx * to.dx - dy * to.dy;
        if (out <= 0.0 || in <= 0.0) return;
        const double first = path * before / (before + after);
        const Point at{image.x + dx * first, image.y + dy * first};
        const double along = (at.x - face.x) * -face.normal_y + (at.y - face.y) * face.normal_x;
        if (std::abs(along) > face.half || first < kTouchingBoards) return;
        const double way_x = (at.x - from.x) / first;
        const double way_y = (at.y - from.y) / first;
        if (shaded(shapes_, {from.x, from.y}, way_x, way_y, first, &shape) ||
            shaded(shapes_, at, dx, dy, path - first, &shape))
            return;
        if (&sender_ != &receiver_ && (hidden(receiver_, {from.x, from.y}, way_x, way_y, first) ||
                                       hidden(sender_, at, dx, dy, path - first)))
            return;
        add(e, k, out, in, path, share);
    }

    /// Behind the other board's own body?
    static bool hidden(const IrBoard& board, const Point& from, double dx, double dy, double length) {
        const Shape body = circle_shape(board.x(), board.y(), board.parameters().ring, 1.0, 0.0);
        const Shape* const shapes[] = {&body};
        return shaded(shapes, from, dx, dy, length);
    }

    void add(std::size_t e, std::size_t k, double out, double in, double path, double share) {
        const auto& from = sender_.emitters()[e];
        const auto& to = receiver_.receivers()[k];
        const double emitted = from.gain * board_lobe(out, tx_.emitter_exponent);
        const double falloff = (rx_.reach + rx_.source_offset) / (path + rx_.source_offset);
        const double carrier = carrier_scale_ * share * emitted * to.demodulator *
                               board_lobe(in, rx_.demodulator_exponent) * falloff * falloff;
        const double bright = power_ * share;
        double level = 0.0;
        if (bright > 0.0) {
            const double seen_path = (path + rx_.source_offset) / std::sqrt(bright) - rx_.source_offset;
            level = level_scale_ * emitted * to.gain * board_lobe(in, rx_.receiver_exponent) *
                    receiver_.level(seen_path);
        }
        result.carrier[e][k] += static_cast<float>(carrier);
        result.level[e][k] += static_cast<float>(level);
        result.any = true;
    }

    const IrBoard& sender_;
    const IrBoard& receiver_;
    std::span<const Shape* const> shapes_;
    const IrParameters& tx_;
    const IrParameters& rx_;
    double power_, carrier_scale_, level_scale_;
};

}  // namespace

IrCoupling couple(const IrBoard& sender, const IrBoard& receiver, const IrDrive& drive,
                  std::span<const Shape* const> shapes, std::span<const Shape* const> mirrors) {
    Coupler coupler(sender, receiver, drive, shapes);
    if (&sender == &receiver)
        coupler.own();
    else
        coupler.direct();
    for (const Shape* mirror : mirrors)
        coupler.mirrored(*mirror);
    return coupler.result;
}

}  // namespace puckloop::physics
