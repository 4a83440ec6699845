#include "physics/sensors/pheromone.h"

#include "physics/description/plan.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr std::uint16_t kNoSignal = 0xFFFF;
constexpr double kStepTime = 1e-3;     // s, of pass()
constexpr double kStableSpread = 0.2;  // of an explicit scheme in the plane; at 0.25 it oscillates
constexpr double kForgotten = 1e-9;    // of full: nobody sees it, and tiny numbers are slow

}  // namespace

PheromoneField::PheromoneField(const Pheromone& pheromone, const World& world) : pheromone_(pheromone) {
    const TrailCells cells = trail_cells(pheromone, world.arena);
    left_ = cells.left;
    bottom_ = cells.bottom;
    columns_ = static_cast<std::size_t>(cells.columns);
    rows_ = static_cast<std::size_t>(cells.rows);
    amount_.assign(columns_ * rows_, 0.0);
    next_ = amount_;
    there_.assign(columns_ * rows_, 0);
    for (std::size_t row = 0; row < rows_; ++row)
        for (std::size_t column = 0; column < columns_; ++column) {
            const Point point = middle(column, row);
            there_[row * columns_ + column] = inside(world.arena.corners, point.x, point.y) ? 1 : 0;
        }
    for (const Robot& robot : world.robots) {
        Layer layer;
        layer.lays = includes_robot(pheromone.robots, robot.name);
        layer.needs_led = !pheromone.led.empty();
        const auto id = robot.board_signals.find(pheromone.led);
        layer.signal = id == robot.board_signals.end() ? kNoSignal : id->second;
        layers_.push_back(layer);
    }
}

Point PheromoneField::middle(std::size_t column, std::size_t row) const {
    return {left_ + (static_cast<double>(column) + 0.5) * pheromone_.cell,
            bottom_ + (static_cast<double>(row) + 0.5) * pheromone_.cell};
}

void PheromoneField::board_signal(std::size_t robot, std::uint16_t id, double value) {
    Layer& layer = layers_[robot];
    if (layer.needs_led && layer.signal == id) layer.lit = value != 0.0;
}

bool PheromoneField::laid_by(std::size_t robot) const {
    const Layer& layer = layers_[robot];
    return layer.lays && (!layer.needs_led || layer.lit);
}

void PheromoneField::lay(double x, double y, double seconds) {
    const double cell = pheromone_.cell, radius = pheromone_.radius;
    const double share = seconds / pheromone_.fill_time;
    const auto first = [&](double from) {
        return static_cast<std::size_t>(std::max(0.0, std::floor((from - radius) / cell)));
    };
    const auto last = [&](double from, std::size_t count) {
        const double end = std::floor((from + radius) / cell) + 1;
        return static_cast<std::size_t>(std::clamp(end, 0.0, static_cast<double>(count)));
    };
    const std::size_t right = last(x - left_, columns_), top = last(y - bottom_, rows_);
    for (std::size_t row = first(y - bottom_); row < top; ++row)
        for (std::size_t column = first(x - left_); column < right; ++column) {
            const Point point = middle(column, row);
            const std::size_t at = row * columns_ + column;
            if (there_[at] == 0 || std::hypot(point.x - x, point.y - y) > radius) continue;
            amount_[at] = std::min(1.0, amount_[at] + share);
            any_ = true;
        }
}

void PheromoneField::pass(std::uint64_t steps) {
    if (!any_) return;
    const double seconds = static_cast<double>(steps) * kStepTime;
    if (pheromone_.half_life > 0.0) {
        const double left = std::exp2(-seconds / pheromone_.half_life);
        double most = 0.0;
        for (double& amount : amount_)
            most = std::max(most, amount *= left);
        if (most < kForgotten) {
            std::fill(amount_.begin(), amount_.end(), 0.0);
            any_ = false;
        }
    }
    if (pheromone_.diffusion <= 0.0) return;
    since_spread_ += steps;
    const auto interval = static_cast<std::uint64_t>(std::llround(kSpreadInterval / kStepTime));
    for (; since_spread_ >= interval; since_spread_ -= interval) {
        const double share = spread_of(pheromone_);
        const double rounds = std::ceil(share / kStableSpread);
        for (double round = 0; round < rounds; ++round)
            spread(share / rounds);
    }
}

/// Each square gives each neighbour inside the arena such a share of what it has more: nothing is lost.
void PheromoneField::spread(double share) {
    next_ = amount_;
    const auto exchange = [&](std::size_t a, std::size_t b) {
        if (there_[a] == 0 || there_[b] == 0) return;
        const double flow = share * (amount_[a] - amount_[b]);
        next_[a] -= flow;
        next_[b] += flow;
    };
    for (std::size_t row = 0; row < rows_; ++row)
        for (std::size_t column = 0; column < columns_; ++column) {
            const std::size_t at = row * columns_ + column;
            if (column + 1 < columns_) exchange(at, at + 1);
            if (row + 1 < rows_) exchange(at, at + columns_);
        }
    amount_.swap(next_);
}

double PheromoneField::strength(double x, double y) const {
    if (!any_) return 0.0;
    const double across = (x - left_) / pheromone_.cell - 0.5, up = (y - bottom_) / pheromone_.cell - 0.5;
    const double column = std::floor(across), row = std::floor(up);
    const auto at = [&](double c, double r) {
        if (c < 0 || r < 0 || c >= static_cast<double>(columns_) || r >= static_cast<double>(rows_))
            return 0.0;
        return amount_[static_cast<std::size_t>(r) * columns_ + static_cast<std::size_t>(c)];
    };
    const double right = across - column, over = up - row;
    return (1 - over) * ((1 - right) * at(column, row) + right * at(column + 1, row)) +
           over * ((1 - right) * at(column, row + 1) + right * at(column + 1, row + 1));
}

}  // namespace puckloop::physics
