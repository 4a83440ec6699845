#include "physics/world/world_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr const char* kSide[] = {"left", "right"};

/// No "-0.0000".
double tidy_logged(double value) {
    return std::abs(value) < 5e-5 ? 0.0 : value;
}

double degrees(double radians) {
    return tidy_logged(std::remainder(radians, 2 * std::numbers::pi) * 180 / std::numbers::pi);
}

std::string at(double x, double y) {
    return fmt::format("({:.4f}, {:.4f}) m", tidy_logged(x), tidy_logged(y));
}

std::string mass_of(bool movable, double mass) {
    return movable ? fmt::format(", movable, {:.4g} kg", mass) : std::string();
}

std::string pose(const RobotState& s) {
    return fmt::format("{}, heading {:.2f} deg", at(s.x, s.y), degrees(s.heading));
}

}  // namespace

WorldLog::WorldLog(const WorldModel& world)
    : log_(world.description().recording.log),
      logged_(world.robot_count()),
      interrupted_(world.booth_count()) {
    for (const Robot& robot : world.description().robots)
        robots_.push_back(robot.name);
    if (log_.is_open()) elements(world.description());
}

void WorldLog::elements(const World& world) {
    std::string corners;
    for (const Point& corner : world.arena.corners)
        corners += " " + at(corner.x, corner.y);
    write(fmt::format("arena {} walls, corners{}", world.arena.walls ? "with" : "without", corners));
    for (const Wall& wall : world.walls)
        write(fmt::format("wall {} from {} to {}", wall.name, at(wall.from.x, wall.from.y),
                          at(wall.to.x, wall.to.y)));
    for (const Box& box : world.boxes)
        write(fmt::format("box {} at {}, heading {:.2f} deg, {:.4g} x {:.4g} x {:.4g} m{}", box.name,
                          at(box.x, box.y), degrees(box.heading), box.length, box.width, box.height,
                          mass_of(box.movable, box.mass)));
    for (const Cylinder& cylinder : world.cylinders)
        write(fmt::format("cylinder {} at {}, radius {:.4g} m, height {:.4g} m{}", cylinder.name,
                          at(cylinder.x, cylinder.y), cylinder.radius, cylinder.height,
                          mass_of(cylinder.movable, cylinder.mass)));
    for (const Lamp& lamp : world.lamps)
        write(fmt::format("lamp {} at {}, height {:.4g} m, intensity {:.4g}", lamp.name, at(lamp.x, lamp.y),
                          lamp.height, lamp.intensity));
    for (const Patch& patch : world.patches)
        write(fmt::format("floor patch {} at {}, {}", patch.name, at(patch.x, patch.y),
                          patch.image.empty()
                              ? fmt::format("grey {:.4g}", patch.grey)
                              : fmt::format("{:.4g} x {:.4g} m, image of {} x {} pixels", patch.length,
                                            patch.width, patch.image.width(), patch.image.height())));
    for (const Booth& booth : world.booths)
        write(fmt::format("tam {} at {}, opening towards {:.2f} deg", booth.name, at(booth.x, booth.y),
                          degrees(booth.heading)));
    for (const Robot& robot : world.robots)
        write(fmt::format("robot {} at {}, heading {:.2f} deg", robot.name, at(robot.x, robot.y),
                          degrees(robot.heading)));
}

std::string WorldLog::name_of(const WorldModel& world, const RobotContact& contact) const {
    switch (contact.kind) {
    case RobotContact::Kind::Fixed:
        return world.fixed_names()[contact.other];
    case RobotContact::Kind::Object:
        return world.object_names()[contact.other];
    case RobotContact::Kind::Robot:
        return robots_[contact.other];
    }
    return {};
}

void WorldLog::note(double seconds, const std::string& text) {
    seconds_ = seconds;
    write(text);
}

void WorldLog::after_step(const WorldModel& world) {
    if (!log_.is_open()) return;
    seconds_ = world.seconds();
    contacts(world);
    drives(world);
    beams(world);
    if (ode_warnings_ == 0 && world.dynamics().ode_warnings() > 0)
        write("first message of ODE: " + world.dynamics().first_ode_warning());
    ode_warnings_ = world.dynamics().ode_warnings();
}

void WorldLog::contacts(const WorldModel& world) {
    const std::uint64_t now = world.steps_done();
    for (const RobotContact& contact : world.dynamics().robot_contacts()) {
        const auto [episode, begins] = touching_.try_emplace(contact, Episode{now, now});
        episode->second.last = now;
        if (begins) write(fmt::format("{} touches {}", robots_[contact.robot], name_of(world, contact)));
    }
    for (auto it = touching_.begin(); it != touching_.end();) {
        const auto& [contact, episode] = *it;
        if (now - episode.last < kApart) {
            ++it;
            continue;
        }
        write(fmt::format("{} has left {}: touched it for {:.3f} s, until {:.3f} s", robots_[contact.robot],
                          name_of(world, contact),
                          static_cast<double>(episode.last + 1 - episode.begun) * kStepSeconds,
                          static_cast<double>(episode.last) * kStepSeconds));
        it = touching_.erase(it);
    }
}

void WorldLog::drives(const WorldModel& world) {
    for (std::size_t i = 0; i < logged_.size(); ++i) {
        const RobotModel& robot = world.robot(i);
        Logged& logged = logged_[i];
        for (const Side side : {Side::Left, Side::Right}) {
            const auto index = static_cast<std::size_t>(side);
            const auto lost = static_cast<std::uint64_t>(std::llround(std::abs(robot.drive(side).lost())));
            if (lost < std::max<std::uint64_t>(1, 2 * logged.lost[index])) continue;
            logged.lost[index] = std::bit_floor(lost);
            write(fmt::format("{} {} wheel: {} steps lost so far", robots_[i], kSide[index], lost));
        }
        const bool low = robot.channels()[kBatteryLowChannel] > 0;
        if (low && !logged.battery_low)
            write(fmt::format("{} battery low: {:.3f} V", robots_[i],
                              robot.channels()[kBatteryVoltageChannel]));
        logged.battery_low |= low;
    }
}

void WorldLog::beams(const WorldModel& world) {
    constexpr const char* kBeam[] = {"front", "back"};
    for (std::size_t i = 0; i < interrupted_.size(); ++i)
        for (std::size_t k = 0; k < booth::kBarriers; ++k) {
            const bool now = world.booth(i).barriers[k] > 0.5;
            if (now == interrupted_[i][k]) continue;
            interrupted_[i][k] = now;
            write(fmt::format("{}: {} beam {}", world.description().booths[i].name, kBeam[k],
                              now ? "interrupted" : "free"));
        }
}

void WorldLog::end(const WorldModel& world) {
    if (!log_.is_open()) return;
    seconds_ = world.seconds();
    for (const auto& [contact, episode] : touching_)
        write(fmt::format("{} touched {} for {:.3f} s, until {:.3f} s", robots_[contact.robot],
                          name_of(world, contact),
                          static_cast<double>(episode.last + 1 - episode.begun) * kStepSeconds,
                          static_cast<double>(episode.last) * kStepSeconds));
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        const RobotModel& robot = world.robot(i);
        write(fmt::format("{} ends at {}; steps lost: {:.0f} left, {:.0f} right; battery {:.3f} V",
                          robots_[i], pose(world.state(i)), tidy_logged(robot.drive(Side::Left).lost()),
                          tidy_logged(robot.drive(Side::Right).lost()),
                          robot.channels()[kBatteryVoltageChannel]));
    }
    for (std::size_t i = 0; i < world.object_names().size(); ++i)
        write(fmt::format("{} ends at {}, heading {:.2f} deg", world.object_names()[i],
                          at(world.object(i).x, world.object(i).y), degrees(world.object(i).heading)));
    write(fmt::format("end: {} steps of 1 ms, {} messages of ODE", world.steps_done(),
                      world.dynamics().ode_warnings()));
}

}  // namespace puckloop::physics
