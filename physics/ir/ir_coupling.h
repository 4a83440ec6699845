#pragma once
// How much of one board's infra-red arrives at another: twelve emitters and twelve receivers at their places,
// lobes, distance, shade, mirrors. Source: the range-and-bearing facts, section 5 (signal model).
//
// The board has two ways of looking at light, and so has the model:
// - the *carrier* that a demodulator sees falls with the inverse square of the path, in units of what all
//   emitters at the reference power yield at ir.reach;
// - the *level* that the strength measurement sees is a measured curve of the path, in A/D counts. It is flat
//   in the far field, as measured, so it cannot be what limits the reach. More or less power is a shorter or
//   longer path on that curve.
//
// Deviations: 1. contributions of emitters add up linearly in both. 2. Everything happens in plan, at the
// height of the board. 3. Light meets at most one mirror; mirrors are smooth, their edges do not scatter.

#include "physics/description/parameters.h"
#include "physics/description/plan.h"

#include <cstdint>
#include <span>

namespace puckloop::physics {

template <class T>
using IrArray = std::array<T, kIrSensors>;

/// One board: where it is, how its parts differ, how it is set.
class IrBoard {
  public:
    /// Part spreads are drawn from the streams "ir/<name>/emitters", "/receivers", "/demodulators".
    IrBoard(const IrParameters& parameters, std::uint64_t seed, std::string_view name);

    void place(double x, double y, double heading);
    double x() const { return x_; }
    double y() const { return y_; }
    double heading() const { return heading_; }
    const IrParameters& parameters() const { return parameters_; }

    /// A part in the world's plan: place and outward direction.
    struct Part {
        double x = 0.0, y = 0.0, dx = 1.0, dy = 0.0;
        double gain = 1.0;  ///< an emitter's; of a receiver that of the strength
        double demodulator = 1.0;
    };
    const IrArray<Part>& emitters() const { return emitters_; }
    const IrArray<Part>& receivers() const { return receivers_; }

    /// Current in the emitters at a potentiometer byte 0..255, relative to the reference byte.
    double power(double potentiometer) const;
    /// Response of its demodulators to a carrier of `hertz`, 1 at the centre frequency, 0 without carrier.
    double response(double hertz) const;
    /// Counts that one emitter adds at the strength measurement of a receiver that faces it, over a free path
    /// of `metres`. Beyond the last point of the curve it falls with the inverse square.
    double level(double metres) const;

  private:
    IrParameters parameters_;
    std::array<double, kIrCurvePoints> log_level_{};
    double x_ = 0.0, y_ = 0.0, heading_ = 0.0;
    IrArray<Part> own_emitters_, own_receivers_;  // in the board's frame
    IrArray<Part> emitters_, receivers_;
};

/// [emitter][receiver]; carrier in units of ir.reach, level in counts.
struct IrCoupling {
    IrArray<IrArray<float>> carrier{}, level{};
    bool any = false;
};

/// How the sending board is set.
struct IrDrive {
    double power = 1.0;       ///< IrBoard::power of the sender
    double carrier_hz = 0.0;  ///< 0: demodulators see nothing
};

/// `shapes` is what shades, without the two boards' own bodies; `mirrors` are those of the shapes whose faces
/// reflect. With sender and receiver the same board: self-coupling and mirrors.
IrCoupling couple(const IrBoard& sender, const IrBoard& receiver, const IrDrive& drive,
                  std::span<const Shape* const> shapes, std::span<const Shape* const> mirrors);

}  // namespace puckloop::physics
