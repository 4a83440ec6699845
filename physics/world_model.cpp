#include "physics/world_model.h"

#include "physics/robot_parameters.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

// Sensors look again when something moved by more than this: far below one count anywhere.
constexpr double kSeenShift = 2e-6;  // m
constexpr double kSeenTurn = 5e-5;   // rad

World checked(World description) {
    check(description);
    return description;
}

}  // namespace

void WorldModel::Moving::update(double new_x, double new_y, double new_heading) {
    moved = std::abs(new_x - x) > kSeenShift || std::abs(new_y - y) > kSeenShift ||
            std::abs(new_heading - heading) > kSeenTurn;
    if (!moved) return;
    x = new_x;
    y = new_y;
    heading = new_heading;
    shape.place(x, y, heading);
}

WorldModel::WorldModel(World description)
    : description_(checked(std::move(description))),
      parameters_(with({}, description_.parameters)),
      fixed_(fixed_shapes(description_)),
      fixed_names_(physics::fixed_names(description_)),
      dynamics_(parameters_, fixed_) {
    add_bodies();
    look();
}

void WorldModel::add_bodies() {
    for (const auto& robot : description_.robots) {
        robots_.emplace_back(description_, robot, with(parameters_, robot.parameters));
        const auto& body = robots_.back().body();
        dynamics_.add_robot(body, robot.x, robot.y, robot.heading);
        moving_.push_back({circle_shape(robot.x, robot.y, body.radius, body.height, body.reflectivity),
                           robot.x, robot.y, robot.heading});
        looked_tilt_.push_back({0.0, 0.0});
    }
    for (const auto& box : description_.boxes)
        if (box.movable) add_object(shape_of(box), box.name, box.heading, box.mass);
    for (const auto& cylinder : description_.cylinders)
        if (cylinder.movable) add_object(shape_of(cylinder), cylinder.name, 0.0, cylinder.mass);
}

void WorldModel::add_object(const Shape& shape, const std::string& name, double heading, double mass) {
    dynamics_.add_object(shape, heading, mass);
    moving_.push_back({shape, shape.x, shape.y, heading});
    object_names_.push_back(name);
}

void WorldModel::wheel(std::size_t robot, Side side, double steps, double seconds) {
    robots_[robot].drive(side).step_to(steps, seconds);
}

void WorldModel::step() {
    move_bodies();
    sense();
}

void WorldModel::move_bodies() {
    ++steps_done_;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        const auto& wheel = dynamics_.robot(i).wheel;
        const double left = robots_[i].wheel_speed(Side::Left, seconds(), wheel[0]);
        const double right = robots_[i].wheel_speed(Side::Right, seconds(), wheel[1]);
        dynamics_.drive(i, left, right);
        if (!robots_[i].floor_motion().still())
            dynamics_.move_floor(i, robots_[i].floor_velocity(dynamics_.robot(i), seconds()));
    }
    dynamics_.step();
}

void WorldModel::sense() {
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        const auto& s = dynamics_.robot(i);
        moving_[i].update(s.x, s.y, s.heading);
    }
    for (std::size_t i = 0; i < object_names_.size(); ++i) {
        const auto& s = dynamics_.object(i);
        moving_[robots_.size() + i].update(s.x, s.y, s.heading);
    }
    look();
}

void WorldModel::look() {
    const bool any_moved = scene_changed_ || std::any_of(moving_.begin(), moving_.end(),
                                                         [](const Moving& body) { return body.moved; });
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        look_around(i, any_moved);
        look_down(i);
        robots_[i].sense_each_step(dynamics_.robot(i), seconds());
    }
    scene_changed_ = false;
}

bool WorldModel::neighbour_moved(std::size_t robot) const {
    const auto& own = moving_[robot];
    const double horizon = robots_[robot].proximity().horizon();
    return std::any_of(moving_.begin(), moving_.end(), [&](const Moving& body) {
        return body.moved && std::hypot(body.x - own.x, body.y - own.y) < horizon + 2 * body.shape.radius;
    });
}

void WorldModel::look_around(std::size_t index, bool any_moved) {
    auto& robot = robots_[index];
    const auto& own = moving_[index];
    const auto gather = [&](double horizon) {
        view_.clear();
        if (robot.lifted()) return;
        const auto see = [&](const Shape& shape) {
            if (shape.height <= 0.0) return;
            const double reach = horizon + shape.radius;
            const double dx = shape.x - own.x;
            const double dy = shape.y - own.y;
            if (dx * dx + dy * dy < reach * reach) view_.push_back(&shape);
        };
        for (const auto& shape : fixed_)
            see(shape);
        for (std::size_t i = 0; i < moving_.size(); ++i)
            if (i != index) see(moving_[i].shape);
    };
    const RobotState seen{.x = own.x, .y = own.y, .heading = own.heading};
    if (any_moved || robot.light().varies_with_time()) {
        if (own.moved || scene_changed_ || !description_.lamps.empty() || robot.light().varies_with_time()) {
            constexpr double kEverything = 1e4;
            view_.clear();
            if (!description_.lamps.empty()) gather(kEverything);
            robot.sense_light({seen, view_, seconds()});
        }
    }
    if (scene_changed_ || neighbour_moved(index)) {
        gather(robot.proximity().horizon());
        std::erase_if(view_, [&](const Shape* s) { return s->height < robot.sensor_height(); });
        robot.look_around({seen, view_, seconds()});
    }
}

void WorldModel::look_down(std::size_t index) {
    const auto& state = dynamics_.robot(index);
    auto& tilt = looked_tilt_[index];
    const bool tilted =
        std::abs(state.pitch - tilt[0]) > kSeenTurn || std::abs(state.roll - tilt[1]) > kSeenTurn;
    if (!scene_changed_ && !moving_[index].moved && !tilted) return;
    tilt = {state.pitch, state.roll};
    robots_[index].look_down(state);
}

}  // namespace puckloop::physics
