#pragma once
// What an instrument can report, and how its errors follow each other.

namespace puckloop::gap {

/// What the instrument can say of a column: clip levels and step; NaN / 0 = not known.
struct Instrument {
    double floor, ceiling;  ///< values at or beyond are "at least this far"; NaN: none
    bool at_end(double value) const { return value <= floor || value >= ceiling; }
    double clipped(double value) const { return value < floor ? floor : value > ceiling ? ceiling : value; }
    double quantum = 0.0;  ///< step between two values
};

/// How the rows of an observable depend on each other.
enum class NoiseKind {
    Carry,  ///< each error keeps a share of the one before (first-order autoregression)
    Level,  ///< measurement noise on a sum that drifts (random walk plus noise)
    Event,  ///< happened or not
};

}  // namespace puckloop::gap
