#include "view/recording/arena_json.h"

#include "base/json.h"
#include "physics/description/booth.h"
#include "physics/description/plan.h"
#include "physics/description/robot_parameters.h"

#include <cmath>

namespace puckloop::view {

namespace {

using nlohmann::ordered_json;

constexpr double kLampSign = 0.02;  // m: the circle that stands for a virtual lamp

ordered_json shape_json(const physics::Shape& shape, const std::string& name) {
    ordered_json json{{"name", name}, {"x", shape.x}, {"y", shape.y}};
    if (shape.kind == physics::Shape::Kind::Circle) {
        json["radius"] = shape.radius;
        return json;
    }
    json["heading"] = std::atan2(shape.sine, shape.cosine);
    json["length"] = 2 * shape.half_length;
    json["width"] = 2 * shape.half_width;
    return json;
}

ordered_json patch_json(const physics::Patch& patch) {
    ordered_json json{{"name", patch.name}, {"x", patch.x}, {"y", patch.y}, {"grey", patch.grey}};
    if (patch.shape == physics::Patch::Shape::Disc) {
        json["radius"] = patch.radius;
        return json;
    }
    json["heading"] = patch.heading;
    json["length"] = patch.length;
    json["width"] = patch.width;
    if (!patch.image.empty())
        json["image"] = {
            {"width", patch.image.width()}, {"height", patch.image.height()}, {"pixels", patch.image.text()}};
    return json;
}

}  // namespace

std::string arena_json(const physics::World& world) {
    ordered_json fixed = ordered_json::array(), things = ordered_json::array(),
                 patches = ordered_json::array(), lamps = ordered_json::array(),
                 speakers = ordered_json::array(), robots = ordered_json::array(),
                 booths = ordered_json::array(), corners = ordered_json::array(),
                 virtuals = ordered_json::array(), trails = ordered_json::array();
    for (const physics::Point& corner : world.arena.corners)
        corners.push_back({corner.x, corner.y});
    for (const physics::Shape& wall : physics::arena_walls(world.arena))
        fixed.push_back(shape_json(wall, ""));
    for (const physics::Wall& wall : world.walls)
        fixed.push_back(shape_json(shape_of(wall), wall.name));
    for (const physics::Box& box : world.boxes)
        things.push_back(shape_json(shape_of(box), box.name));
    for (const physics::Cylinder& cylinder : world.cylinders)
        things.push_back(shape_json(shape_of(cylinder), cylinder.name));
    for (const physics::VirtualBody& body : physics::virtual_bodies(world.virtuals))
        virtuals.push_back(shape_json(body.shape, body.name));
    for (const physics::Lamp& lamp : world.virtuals.lamps)
        virtuals.push_back({{"name", lamp.name}, {"x", lamp.x}, {"y", lamp.y}, {"radius", kLampSign}});
    for (const physics::Patch& patch : world.patches)
        patches.push_back(patch_json(patch));
    for (const physics::Lamp& lamp : world.lamps)
        lamps.push_back({{"name", lamp.name}, {"x", lamp.x}, {"y", lamp.y}, {"intensity", lamp.intensity}});
    for (const physics::Speaker& speaker : world.speakers)
        speakers.push_back({{"name", speaker.name},
                            {"x", speaker.x},
                            {"y", speaker.y},
                            {"on", speaker.on},
                            {"off", speaker.off},
                            {"every", speaker.every},
                            {"times", speaker.times}});
    for (const physics::Pheromone& trail : world.virtuals.pheromones)
        trails.push_back({{"name", trail.name}, {"side", trail.cell}, {"grey", trail.grey}});
    for (const physics::Robot& robot : world.robots) {
        const auto body = parameters_of(world, robot).robot;
        robots.push_back({{"name", robot.name},
                          {"x", robot.x},
                          {"y", robot.y},
                          {"heading", robot.heading},
                          {"radius", body.radius},
                          {"axle", body.axle_length},
                          {"wheel", body.wheel_radius_left},
                          {"rab", robot.rab}});
    }
    for (const physics::Booth& booth : world.booths) {
        ordered_json parts = ordered_json::array();
        for (const physics::Shape& part : shapes_of(booth))
            parts.push_back(shape_json(part, ""));
        booths.push_back({{"name", booth.name},
                          {"x", booth.x},
                          {"y", booth.y},
                          {"heading", booth.heading},
                          {"parts", parts}});
    }
    const ordered_json json{{"corners", corners},   {"floor", world.arena.floor_grey},
                            {"fixed", fixed},       {"things", things},
                            {"patches", patches},   {"lamps", lamps},
                            {"speakers", speakers}, {"robots", robots},
                            {"booths", booths},     {"virtuals", virtuals},
                            {"trails", trails}};
    return json.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace puckloop::view
