#include "physics/tracker/tracker.h"

#include "physics/description/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace puckloop::physics {

Tracker::Tracker(const TrackerSpec& spec, std::vector<Point> corners, std::uint64_t seed, std::size_t robots)
    : spec_(spec),
      corners_(std::move(corners)),
      noise_(seed, "tracker.noise"),
      losses_(seed, "tracker.loss"),
      swaps_(seed, "tracker.swap"),
      label_(robots),
      lost_(robots) {
    std::iota(label_.begin(), label_.end(), std::size_t{0});
}

bool Tracker::due(std::uint64_t step) const {
    // Frame k is due at k / frame_rate: counted, so that no error adds up.
    return static_cast<double>(step) >= static_cast<double>(frames_) * 1000.0 / spec_.frame_rate - 1e-6;
}

TrackerFrame Tracker::see(std::uint64_t step, std::span<const RobotState> robots) {
    TrackerFrame frame{.number = frames_++,
                       .step = step,
                       .arrives = step + static_cast<std::uint64_t>(std::llround(spec_.latency * 1000.0))};
    swap_labels(robots);
    for (std::size_t i = 0; i < robots.size(); ++i) {
        const RobotState& robot = robots[i];
        // Drawn for lost robots too: whether one is lost does not move the noise of others.
        const double x = robot.x + spec_.position_noise * noise_.normal(),
                     y = robot.y + spec_.position_noise * noise_.normal(),
                     heading = robot.heading + spec_.heading_noise * noise_.normal();
        if (lost(i, robot)) continue;
        frame.robots.push_back({label_[i], x, y, std::remainder(heading, 2 * std::numbers::pi)});
    }
    std::sort(frame.robots.begin(), frame.robots.end(),
              [](const TrackedRobot& a, const TrackedRobot& b) { return a.robot < b.robot; });
    return frame;
}

void Tracker::swap_labels(std::span<const RobotState> robots) {
    if (spec_.swap <= 0.0) return;
    for (std::size_t i = 0; i < robots.size(); ++i)
        for (std::size_t k = i + 1; k < robots.size(); ++k) {
            if (std::hypot(robots[i].x - robots[k].x, robots[i].y - robots[k].y) > spec_.swap_distance)
                continue;
            if (swaps_.uniform() < spec_.swap) std::swap(label_[i], label_[k]);
        }
}

bool Tracker::at_edge(const RobotState& state) const {
    return spec_.edge_loss > 0.0 &&
           (!inside(corners_, state.x, state.y) || edge_distance(corners_, state.x, state.y) <= spec_.edge);
}

bool Tracker::lost(std::size_t robot, const RobotState& state) {
    const double drawn = losses_.uniform();
    if (lost_[robot])
        lost_[robot] = drawn >= 1.0 - std::exp(-1.0 / (spec_.frame_rate * spec_.loss_time));
    else
        lost_[robot] = drawn < (at_edge(state) ? std::max(spec_.loss, spec_.edge_loss) : spec_.loss);
    return lost_[robot];
}

}  // namespace puckloop::physics
