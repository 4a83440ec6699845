#pragma once
// From the board's strength to a distance: the curve published with ARGoS's e-puck,
//     distance = gain * exp(9.06422 - 0.00565075 * strength) cm,
// fact sheet 5.1. The gain differs from board to board; it is measured with a sender 20 cm away.

#include <optional>

namespace puckloop::control {

/// Centimetres between the robots' surfaces. The curve is flat beyond 30 cm, where strength hardly changes.
double range_cm(double strength, double gain);

class RangeCalibration {
  public:
    explicit RangeCalibration(int messages = 100, int own_id = 0) : wanted_(messages), own_id_(own_id) {}

    /// A message's id, signed bearing in rad and strength. Own reflections (own id), boards without a number
    /// (id 0) and messages without a direction (bearing exactly 0) do not count. True when it was counted.
    bool add(int id, double bearing, double strength);
    bool complete() const { return count_ >= wanted_; }
    int count() const { return count_; }
    double mean_strength() const { return count_ == 0 ? 0 : sum_ / count_; }
    double deviation() const;
    /// The gain that makes the mean strength 20 cm; empty before the calibration is complete.
    std::optional<double> gain() const;

  private:
    int wanted_;
    int own_id_;
    int count_ = 0;
    double sum_ = 0;
    double squares_ = 0;
};

}  // namespace puckloop::control
