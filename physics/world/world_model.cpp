#include "physics/world/world_model.h"

#include "physics/description/robot_parameters.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

// Sensors look again when something moved by more than this: far below one count anywhere.
constexpr double kSeenShift = 2e-6;  // m
constexpr double kSeenTurn = 5e-5;   // rad
// Steps between two times at which robots lay trails: at their speed a tenth of a square of 1 cm.
constexpr std::uint64_t kTrailSteps = 10;

World checked_description(World description) {
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
    : description_(checked_description(std::move(description))),
      parameters_(with({}, description_.parameters)),
      fixed_(fixed_shapes(description_)),
      fixed_names_(physics::fixed_names(description_)),
      dynamics_(parameters_, fixed_),
      virtual_bodies_(physics::virtual_bodies(description_.virtuals)) {
    for (const Pheromone& pheromone : description_.virtuals.pheromones)
        trails_.emplace_back(pheromone, description_);
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
    for (const auto& booth : description_.booths)
        booths_.emplace_back(booth);
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

void WorldModel::board_signal(std::size_t robot, std::uint16_t id, double value) {
    for (PheromoneField& trail : trails_)
        trail.board_signal(robot, id, value);
}

void WorldModel::step() {
    move_bodies();
    sense();
}

void WorldModel::observe(StepObserver* observer) {
    observer_ = observer;
    dynamics_.observe(observer);
}

void WorldModel::move_bodies() {
    ++steps_done_;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        const auto& wheel = dynamics_.robot(i).wheel;
        const double left = robots_[i].wheel_speed(Side::Left, seconds(), wheel[0]);
        const double right = robots_[i].wheel_speed(Side::Right, seconds(), wheel[1]);
        dynamics_.drive(i, left, right);
        if (!robots_[i].floor_is_still())
            dynamics_.move_floor(i, robots_[i].floor_velocity(dynamics_.robot(i), seconds()));
    }
    done(StepPart::Inputs);
    dynamics_.step();
    done(StepPart::Poses);
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
    refresh_neighbours();
    for (std::size_t i = 0; i < robots_.size(); ++i)
        look_at_lamps(i, any_moved);
    done(StepPart::Light);
    for (std::size_t i = 0; i < robots_.size(); ++i)
        look_around(i);
    done(StepPart::Around);
    renew_trails();
    for (std::size_t i = 0; i < robots_.size(); ++i)
        look_down(i);
    done(StepPart::Ground);
    look_at_barriers();
    for (std::size_t i = 0; i < robots_.size(); ++i)
        robots_[i].sense_each_step(dynamics_.robot(i), seconds());
    done(StepPart::Readings);
    scene_changed_ = false;
    trails_changed_ = false;
}

/// Robots on the floor lay; what lies there evaporates and spreads.
void WorldModel::renew_trails() {
    if (trails_.empty() || steps_done_ == 0 || steps_done_ % kTrailSteps != 0) return;
    for (PheromoneField& trail : trails_) {
        for (std::size_t i = 0; i < robots_.size(); ++i)
            if (!robots_[i].lifted() && trail.laid_by(i))
                trail.lay(dynamics_.robot(i).x, dynamics_.robot(i).y,
                          static_cast<double>(kTrailSteps) * kStepSeconds);
        trail.pass(kTrailSteps);
    }
    trails_changed_ = true;
}

void WorldModel::refresh_neighbours() {
    const auto at = [&](std::size_t i) -> const Moving& { return moving_[i]; };
    if (!scene_changed_ && near_.hold(moving_.size(), at)) return;
    std::vector<Disc> moving;
    std::vector<double> reach;
    std::vector<const Shape*> still;
    for (const Moving& body : moving_)
        moving.push_back({body.x, body.y, body.shape.radius});
    for (const RobotModel& robot : robots_)
        reach.push_back(robot.proximity().horizon());
    for (const Shape& shape : fixed_)
        still.push_back(&shape);
    near_.make(std::move(moving), reach, still);
}

/// The robot itself, or something that it may see.
bool WorldModel::neighbour_moved(std::size_t robot) const {
    const auto others = near_.moving(robot);
    return moving_[robot].moved ||
           std::any_of(others.begin(), others.end(), [&](std::uint32_t i) { return moving_[i].moved; });
}

void WorldModel::look_at_lamps(std::size_t index, bool any_moved) {
    auto& robot = robots_[index];
    const bool lamps = !description_.lamps.empty() || !description_.virtuals.lamps.empty();
    if (!scene_changed_ && !robot.light().varies_with_time() && !(lamps && any_moved)) return;
    view_.clear();
    if (lamps && !robot.lifted()) {
        for (const Shape& shape : fixed_)
            if (shape.height > 0.0) view_.push_back(&shape);
        for (std::size_t i = 0; i < moving_.size(); ++i)
            if (i != index && moving_[i].shape.height > 0.0) view_.push_back(&moving_[i].shape);
    }
    const auto& own = moving_[index];
    const RobotState seen{.x = own.x, .y = own.y, .heading = own.heading};
    robot.sense_light({seen, view_, seconds()});
}

void WorldModel::look_around(std::size_t index) {
    if (!scene_changed_ && !neighbour_moved(index)) return;
    auto& robot = robots_[index];
    const auto& own = moving_[index];
    const double horizon = robot.proximity().horizon();
    view_.clear();
    const auto see = [&](const Shape& shape) {
        if (shape.height <= 0.0 || shape.height < robot.sensor_height()) return;
        // Nearer than the horizon by its edge, not only by the circle around it: long walls have a wide one.
        constexpr double kRounding = 1e-6;
        if (within(shape, own.x, own.y, horizon + kRounding)) view_.push_back(&shape);
    };
    if (!robot.lifted()) {
        for (const std::uint32_t i : near_.fixed(index))
            see(fixed_[i]);
        for (const std::uint32_t i : near_.moving(index))
            see(moving_[i].shape);
        const std::string& name = description_.robots[index].name;
        for (const VirtualBody& body : virtual_bodies_)
            if (body.sensed_by(name)) see(body.shape);
    }
    const RobotState seen{.x = own.x, .y = own.y, .heading = own.heading};
    robot.look_around({seen, view_, seconds()});
}

void WorldModel::look_down(std::size_t index) {
    const auto& state = dynamics_.robot(index);
    auto& tilt = looked_tilt_[index];
    const bool tilted =
        std::abs(state.pitch - tilt[0]) > kSeenTurn || std::abs(state.roll - tilt[1]) > kSeenTurn;
    if (!scene_changed_ && !trails_changed_ && !moving_[index].moved && !tilted) return;
    tilt = {state.pitch, state.roll};
    robots_[index].look_down(state, trails_);
}

void WorldModel::look_at_barriers() {
    if (booths_.empty()) return;
    if (scene_changed_) {
        in_booths_.assign(booths_.size(), {});
        for (std::size_t k = built_in_count(description_); k < fixed_.size(); ++k)
            for (std::size_t i = 0; i < booths_.size(); ++i)
                if (booths_[i].near(fixed_[k])) in_booths_[i].push_back(k);
    }
    for (std::size_t i = 0; i < booths_.size(); ++i) {
        view_.clear();
        for (const std::size_t k : in_booths_[i])
            view_.push_back(&fixed_[k]);
        for (const Moving& body : moving_)
            if (booths_[i].near(body.shape)) view_.push_back(&body.shape);
        booths_[i].barriers = booths_[i].interrupted(view_);
    }
}

}  // namespace puckloop::physics
