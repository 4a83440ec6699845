#pragma once
// One trail on the floor, in squares: laid under robots, evaporating, spreading evenly inside the arena.
//
// Deviations: 1. what is under a disc's edge counts by the middles of squares. 2. Ground sensors see the
// floor under their middle, between four squares, not averaged over their spot.

#include "physics/description/description.h"
#include "physics/description/trail_cells.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::physics {

class PheromoneField {
  public:
    /// `world` has passed check(), and contains `pheromone`.
    PheromoneField(const Pheromone& pheromone, const World& world);

    /// An output of a robot's board.
    void board_signal(std::size_t robot, std::uint16_t id, double value);
    /// Does this robot lay now, if it stands on the floor?
    bool laid_by(std::size_t robot) const;
    /// For `seconds` under (x, y).
    void lay(double x, double y, double seconds);
    /// So much later: `steps` of a millisecond.
    void pass(std::uint64_t steps);

    /// 0 none .. 1 full, between the middles of squares; 0 outside the arena.
    double strength(double x, double y) const;
    /// The floor's grey there, of which the floor itself has `grey`.
    double over(double grey, double x, double y) const {
        return grey + (pheromone_.grey - grey) * strength(x, y);
    }

    const Pheromone& description() const { return pheromone_; }
    std::size_t columns() const { return columns_; }
    std::size_t rows() const { return rows_; }
    double value(std::size_t column, std::size_t row) const { return amount_[row * columns_ + column]; }
    Point middle(std::size_t column, std::size_t row) const;

  private:
    struct Layer {
        bool lays = false;
        std::uint16_t signal = 0;  // of the LED
        bool needs_led = false, lit = false;
    };
    void spread(double share);

    Pheromone pheromone_;
    double left_ = 0.0, bottom_ = 0.0;  // of the squares
    std::size_t columns_ = 0, rows_ = 0;
    std::vector<double> amount_;       // row by row, from the lowest y
    std::vector<std::uint8_t> there_;  // the middle is inside the arena
    std::vector<double> next_;         // scratch
    std::vector<Layer> layers_;        // by robot
    std::uint64_t since_spread_ = 0;   // steps
    bool any_ = false;                 // something has been laid
};

}  // namespace puckloop::physics
