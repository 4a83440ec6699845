#include "benchmark/speeds/world_cost.h"

#include "base/random.h"
#include "benchmark/measures/processor_seconds.h"
#include "emu/i2c_devices/signals.h"
#include "emu/pic/signals.h"
#include "physics/description/channels.h"
#include "physics/node/world_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <map>
#include <numbers>
#include <numeric>
#include <span>
#include <string>
#include <vector>

namespace puckloop::tools {

namespace {

constexpr double kCell = 0.3;  // m: room for each robot
constexpr cosim::Time kStep = cosim::kMillisecond;

class Stopwatch final : public physics::StepObserver {
  public:
    void start() { last_ = processor_seconds(); }
    void done(physics::StepPart part) override {
        const double now = processor_seconds();
        seconds[static_cast<std::size_t>(part)] += now - last_;
        ++calls[static_cast<std::size_t>(part)];
        last_ = now;
    }
    std::array<double, physics::kStepParts> seconds{};
    std::array<double, physics::kStepParts> calls{};

  private:
    double last_ = 0.0;
};

std::map<std::string, std::uint16_t> ids_of(std::span<const cosim::SignalInfo> signals) {
    std::map<std::string, std::uint16_t> ids;
    for (std::size_t i = 0; i < signals.size(); ++i)
        ids[signals[i].name] = static_cast<std::uint16_t>(i);
    return ids;
}

physics::World world_of(const WorldLoad& load) {
    const int side = std::max(1, static_cast<int>(std::ceil(std::sqrt(load.robots))));
    const auto board = ids_of(pic::signals());
    const auto ground = ids_of(i2c_devices::signals());
    physics::World world;
    world.arena = physics::rectangular_arena(kCell * (side + 1), kCell * (side + 1));
    for (int i = 0; i < load.robots; ++i) {
        physics::Robot robot;
        robot.name = fmt::format("robot{}", i);
        robot.x = (i % side - (side - 1) / 2.0) * kCell;
        robot.y = (i / side - (side - 1) / 2.0) * kCell;
        robot.heading = std::remainder(2.4 * i, 2 * std::numbers::pi);
        robot.board_signals = board;
        robot.ground_signals = ground;
        world.robots.push_back(robot);
    }
    for (int i = 0; i < load.lamps; ++i) {
        const double angle = 2 * std::numbers::pi * i / load.lamps;
        world.lamps.push_back({.name = fmt::format("lamp{}", i),
                               .x = 0.5 * kCell * side * std::cos(angle),
                               .y = 0.5 * kCell * side * std::sin(angle),
                               .height = 0.1});
    }
    return world;
}

/// A robot's firmware and program in short: straight on, away from what its front sensors see.
struct Wanderer {
    std::array<double, 8> seen{};  // counts
    std::array<double, 2> speed{}, phase{}, count{};

    void decide(RandomStream& chance) {
        constexpr double kNear = 200.0;
        const double right = seen[0] + seen[1], left = seen[6] + seen[7];
        speed = {400.0, 400.0 + 20.0 * chance.normal()};
        if (std::max(left, right) > kNear)
            speed = left > right ? std::array{300.0, -300.0} : std::array{-300.0, 300.0};
    }
};

class Herd {
  public:
    explicit Herd(const WorldLoad& load)
        : load_(load),
          node_(world_of(load)),
          robots_(static_cast<std::size_t>(load.robots)),
          chance_(1, "bench/world") {
        const auto board = ids_of(pic::signals());
        wheel_ = {board.at("wheel_left"), board.at("wheel_right")};
        for (const auto& [name, id] : board)
            if (name.starts_with("proximity")) sensor_[id] = static_cast<std::size_t>(name.back() - '0');
    }

    void observe(Stopwatch& watch) { node_.observe(&watch); }
    /// Returns how many messages the world sent.
    std::size_t run(double seconds, Stopwatch& watch) {
        std::size_t messages = 0;
        for (long k = std::lround(seconds * 1e3); k > 0; --k, now_ += kStep) {
            inbox_.clear();
            if (load_.moving) drive();
            outbox_.clear();
            watch.start();
            node_.advance(now_ + kStep, inbox_, outbox_);
            messages += outbox_.size();
            look();
        }
        return messages;
    }

  private:
    /// The motors' steps of the millisecond to come.
    void drive() {
        constexpr cosim::Time kDecide = 100 * kStep;
        for (std::size_t i = 0; i < robots_.size(); ++i) {
            Wanderer& robot = robots_[i];
            if (now_ % kDecide == 0) robot.decide(chance_);
            for (std::size_t side = 0; side < 2; ++side) {
                robot.phase[side] += std::abs(robot.speed[side]) * 1e-3;
                if (robot.phase[side] < 1.0) continue;
                robot.phase[side] -= 1.0;
                robot.count[side] += std::copysign(1.0, robot.speed[side]);
                inbox_.push_back({now_ + kStep / 2, static_cast<cosim::PortIndex>(2 * i),
                                  cosim::Signal{wheel_[side], robot.count[side]}});
            }
        }
    }
    void look() {
        for (const cosim::Message& message : outbox_) {
            const auto& signal = std::get<cosim::Signal>(message.payload);
            const auto sensor = sensor_.find(signal.id);
            if (message.port % 2 == 0 && sensor != sensor_.end())
                robots_[message.port / 2].seen[sensor->second] = signal.value;
        }
    }

    WorldLoad load_;
    physics::WorldNode node_;
    std::vector<Wanderer> robots_;
    RandomStream chance_;
    std::array<std::uint16_t, 2> wheel_{};
    std::map<std::uint16_t, std::size_t> sensor_;
    std::vector<cosim::Message> inbox_, outbox_;
    cosim::Time now_ = 0;
};

/// What one call of the stopwatch costs; it is no part of the world's cost.
double seconds_a_call() {
    constexpr int kCalls = 2000;
    Stopwatch idle;
    idle.start();
    for (int i = 0; i < kCalls; ++i)
        idle.done(physics::StepPart::Inputs);
    return idle.seconds[0] / kCalls;
}

}  // namespace

double WorldCost::total_us() const {
    return std::accumulate(part_us.begin(), part_us.end(), 0.0);
}

WorldCost measure_world(const WorldLoad& load) {
    Herd herd(load);
    Stopwatch settling, watch;
    herd.run(load.settle_s, settling);
    herd.observe(watch);
    const std::size_t messages = herd.run(load.simulated_s, watch);
    const double own = seconds_a_call();
    const double robot_steps = load.simulated_s * 1e3 * load.robots;
    WorldCost cost;
    for (std::size_t i = 0; i < physics::kStepParts; ++i)
        cost.part_us[i] = 1e6 * std::max(watch.seconds[i] - watch.calls[i] * own, 0.0) / robot_steps;
    cost.messages = static_cast<double>(messages) / robot_steps;
    return cost;
}

}  // namespace puckloop::tools
