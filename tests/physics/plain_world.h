#pragma once
// What the sensors of a world see, computed plainly: everything against everything, nothing kept from one
// step to the next. The reference for WorldModel, which looks only where something changed.

#include "physics/world/world_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace puckloop::physics::test {

class PlainWorld {
  public:
    explicit PlainWorld(const WorldModel& model) : model_(model) {
        const World& world = model.description();
        for (const Robot& robot : world.robots)
            seen_.push_back({{}, robot.x, robot.y, robot.heading});
        for (const Box& box : world.boxes)
            if (box.movable) seen_.push_back({{}, box.x, box.y, box.heading});
        for (const Cylinder& cylinder : world.cylinders)
            if (cylinder.movable) seen_.push_back({{}, cylinder.x, cylinder.y, 0.0});
        look();
    }

    /// After each of the model's steps: what moved visibly is seen where it is now. `changed`: by hands.
    void look(bool changed = true) {
        const std::size_t robots = model_.robot_count();
        seen_.resize(robots + model_.object_names().size());
        over_ground_.resize(robots);
        for (std::size_t i = 0; i < seen_.size(); ++i) {
            Body& body = seen_[i];
            if (i < robots) {
                const RobotState& now = model_.state(i);
                RobotState& then = over_ground_[i];
                const bool tilted =
                    std::abs(now.pitch - then.pitch) > 5e-5 || std::abs(now.roll - then.roll) > 5e-5;
                if (body.update(now.x, now.y, now.heading) || changed || tilted) then = now;
                body.shape = model_.robot_shape(i);
            } else {
                const ObjectState& now = model_.object(i - robots);
                body.update(now.x, now.y, now.heading);
                body.shape = model_.object_shape(i - robots);
            }
            body.shape.place(body.x, body.y, body.heading);
        }
    }

    /// What robot i's proximity sensors get back of their own light.
    std::array<double, kProximitySensors> reflected(std::size_t robot, const ProximityParameters& p) const {
        std::array<double, kProximitySensors> result{};
        auto shapes = others(robot, p.height);
        for (const VirtualBody& body : model_.virtual_bodies())
            if (!model_.robot(robot).lifted() && body.sensed_by(name(robot)) && body.shape.height >= p.height)
                shapes.push_back(body.shape);
        const Body& own = seen_[robot];
        const double cosine = std::cos(own.heading), sine = std::sin(own.heading);
        const long count = std::lround(p.rays);
        for (std::size_t i = 0; i < kProximitySensors; ++i) {
            double sum = 0.0;
            for (long k = 0; k < count; ++k) {
                const double share =
                    count == 1 ? 0.0 : static_cast<double>(k) / static_cast<double>(count - 1) - 0.5;
                const double angle = p.direction[i] + share * p.aperture;
                const Ray ray =
                    in_world(state(own), cosine, sine, {p.x[i], p.y[i], std::cos(angle), std::sin(angle)});
                double nearest = p.reach, brightness = 0.0;
                for (const Shape& shape : shapes) {
                    const auto hit = chord(shape, ray.x, ray.y, ray.dx, ray.dy);
                    if (!hit || hit->out < 0.0 || hit->in >= nearest) continue;
                    nearest = std::max(hit->in, 0.0);
                    brightness = shape.reflectivity * std::pow(hit->cosine, p.incidence_exponent);
                }
                if (brightness > 0.0) sum += brightness * proximity_response(p, nearest + p.distance_shift);
            }
            result[i] = sum / static_cast<double>(count);
        }
        return result;
    }

    std::array<double, kProximitySensors> ambient(std::size_t robot, const LightParameters& p,
                                                  const ProximityParameters& places) const {
        constexpr double kFullScale = 4095;
        std::array<double, kProximitySensors> counts{};
        const auto shapes = others(robot, 0.0);
        const Body& own = seen_[robot];
        const double cosine = std::cos(own.heading), sine = std::sin(own.heading);
        double room = p.room * model_.description().ambient_light;
        if (p.flicker > 0.0)
            room *= 1.0 + p.flicker * std::sin(2 * std::numbers::pi * p.flicker_frequency * model_.seconds());
        for (std::size_t i = 0; i < kProximitySensors; ++i) {
            const Ray sensor = in_world(
                state(own), cosine, sine,
                {places.x[i], places.y[i], std::cos(places.direction[i]), std::sin(places.direction[i])});
            double light = room;
            for (const Lamp& lamp : model_.description().lamps)
                light += from_lamp(lamp, sensor, p, places.height, shapes);
            for (const auto& lamp : model_.description().virtuals.lamps)
                if (lamp.sensed_by(name(robot))) light += from_lamp(lamp, sensor, p, places.height, shapes);
            counts[i] = std::clamp(p.dark + p.offset[i] - p.span * p.gain[i] * light, 0.0, kFullScale);
        }
        return counts;
    }

    /// Mean grey under each ground sensor.
    std::array<double, kGroundSensors> greys(std::size_t robot, const GroundParameters& p) const {
        const World& world = model_.description();
        return greys(p, world.arena.floor_grey, world.patches, over_ground_[robot]);
    }
    static std::array<double, kGroundSensors> greys(const GroundParameters& p, double base,
                                                    const std::vector<Patch>& patches, const RobotState& at) {
        const double cosine = std::cos(at.heading), sine = std::sin(at.heading);
        const double reach = p.footprint / 2;
        std::array<double, kGroundSensors> result{};
        for (std::size_t i = 0; i < kGroundSensors; ++i) {
            const double x = at.x + cosine * p.x - sine * p.y[i];
            const double y = at.y + sine * p.x + cosine * p.y[i];
            for (const Point& spot :
                 {Point{0, 0}, Point{reach, 0}, Point{-reach, 0}, Point{0, reach}, Point{0, -reach}})
                result[i] += grey(base, patches, x + spot.x, y + spot.y);
            result[i] /= 5.0;
        }
        return result;
    }

    /// Which robots touch what, where everything is now.
    std::vector<RobotContact> contacts() const {
        std::vector<RobotContact> all;
        const auto circle = [&](std::size_t i) {
            Shape shape = model_.robot_shape(i);
            shape.place(model_.state(i).x, model_.state(i).y, model_.state(i).heading);
            return shape;
        };
        for (std::size_t i = 0; i < model_.robot_count(); ++i) {
            if (model_.robot(i).lifted()) continue;
            const Shape own = circle(i);
            const auto meet = [&](RobotContact::Kind kind, std::size_t other, const Shape& shape) {
                const double dx = own.x - shape.x, dy = own.y - shape.y, far = own.radius + shape.radius;
                if (dx * dx + dy * dy <= far * far && touch(shape, own.x, own.y, own.radius).depth > 0)
                    all.push_back({i, kind, other});
            };
            for (std::size_t k = 0; k < model_.fixed_count(); ++k)
                if (model_.fixed(k).height > 0.0) meet(RobotContact::Kind::Fixed, k, model_.fixed(k));
            for (std::size_t k = 0; k < i; ++k)
                if (!model_.robot(k).lifted()) meet(RobotContact::Kind::Robot, k, circle(k));
            for (std::size_t k = 0; k < model_.object_names().size(); ++k) {
                Shape shape = model_.object_shape(k);
                if (shape.height <= 0.0) continue;
                shape.place(model_.object(k).x, model_.object(k).y, model_.object(k).heading);
                meet(RobotContact::Kind::Object, k, shape);
            }
        }
        return all;
    }

  private:
    struct Body {
        Shape shape;
        double x = 0.0, y = 0.0, heading = 0.0;
        /// Movements below 2 um and 50 urad are not seen.
        bool update(double new_x, double new_y, double new_heading) {
            if (std::abs(new_x - x) <= 2e-6 && std::abs(new_y - y) <= 2e-6 &&
                std::abs(new_heading - heading) <= 5e-5)
                return false;
            x = new_x;
            y = new_y;
            heading = new_heading;
            return true;
        }
    };

    const std::string& name(std::size_t robot) const { return model_.description().robots[robot].name; }
    static RobotState state(const Body& body) { return {.x = body.x, .y = body.y, .heading = body.heading}; }

    std::vector<Shape> others(std::size_t robot, double least_height) const {
        std::vector<Shape> all;
        if (model_.robot(robot).lifted()) return all;
        const auto add = [&](const Shape& shape) {
            if (shape.height > 0.0 && shape.height >= least_height) all.push_back(shape);
        };
        for (std::size_t k = 0; k < model_.fixed_count(); ++k)
            add(model_.fixed(k));
        for (std::size_t k = 0; k < seen_.size(); ++k)
            if (k != robot) add(seen_[k].shape);
        return all;
    }

    static double grey(double base, const std::vector<Patch>& patches, double x, double y) {
        for (auto i = patches.size(); i-- > 0;) {
            const Patch& patch = patches[i];
            const double dx = x - patch.x, dy = y - patch.y;
            const double cosine = std::cos(patch.heading), sine = std::sin(patch.heading);
            const bool on = patch.shape == Patch::Shape::Disc
                                ? dx * dx + dy * dy <= patch.radius * patch.radius
                                : std::abs(cosine * dx + sine * dy) <= patch.length / 2 &&
                                      std::abs(cosine * dy - sine * dx) <= patch.width / 2;
            if (on) return patch.grey;
        }
        return base;
    }

    static double from_lamp(const Lamp& lamp, const Ray& sensor, const LightParameters& p, double height,
                            const std::vector<Shape>& shapes) {
        const double dx = lamp.x - sensor.x, dy = lamp.y - sensor.y;
        const double level = std::hypot(dx, dy);
        const double distance = std::hypot(level, lamp.height - height);
        if (distance >= p.range || distance <= 0.0) return 0.0;
        const double cosine = std::clamp((dx * sensor.dx + dy * sensor.dy) / distance, -1.0, 1.0);
        const double facing = 1.0 - std::acos(cosine) * 2.0 / std::numbers::pi;
        if (facing <= 0.0) return 0.0;
        const double x = level > 0.0 ? dx / level : 1.0, y = level > 0.0 ? dy / level : 0.0;
        const double rise = level > 0.0 ? (lamp.height - height) / level : 0.0;
        for (const Shape& shape : shapes) {
            const auto hit = chord(shape, sensor.x, sensor.y, x, y);
            if (!hit || hit->out <= 0.0 || hit->in >= level) continue;
            const double in = height + rise * std::max(hit->in, 0.0);
            const double out = height + rise * std::min(hit->out, level);
            if (std::min(in, out) < shape.height) return 0.0;
        }
        return lamp.intensity * std::exp(-p.decay * distance) * facing;
    }

    const WorldModel& model_;
    std::vector<Body> seen_;
    std::vector<RobotState> over_ground_;
};

}  // namespace puckloop::physics::test
