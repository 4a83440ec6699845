#pragma once
// How far a performance on the emulator is from what was measured, of one observable: row by row, or, of
// what chance puts at other moments each time, as a distribution.

#include <cstddef>
#include <optional>
#include <vector>

namespace puckloop::gap::emulate {

/// Values that are NaN are passed over.
class Comparison {
  public:
    /// Measured less performed, of one row.
    void error(double difference);
    /// What was measured and what was performed, in no order, each with a weight above 0.
    void measured(double value, double weight = 1.0);
    void performed(double value, double weight = 1.0);

    std::size_t rows() const { return errors_; }
    /// Root mean square of the errors. Without errors the area between the two distribution functions (the
    /// Wasserstein distance of first order: mean shift of a value; of what happens or not the difference of
    /// the shares). In the observable's unit; none where there is nothing to compare.
    std::optional<double> off_by() const;

  private:
    struct Weighted {
        double value, weight;
    };
    static void add(std::vector<Weighted>& to, double value, double weight);

    std::size_t errors_ = 0;
    double squares_ = 0.0;
    std::vector<Weighted> measured_, performed_;
};

/// Of errors of several performances of the robot that was recorded: their mean, and what one more of them
/// may have (upper end of the one-sided 95 % prediction interval).
struct Floor {
    double mean = 0.0, limit = 0.0;
};
Floor floor_of(const std::vector<double>& errors);

}  // namespace puckloop::gap::emulate
