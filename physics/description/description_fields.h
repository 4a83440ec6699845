#pragma once
// The fields of the description's structs as JSON. Only files that write or read JSON include this.

#include "base/json.h"
#include "physics/description/description.h"

namespace puckloop::physics {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Point, x, y)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Arena, corners, walls, wall_height, wall_thickness, reflectivity,
                                   floor_grey, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Wall, name, from, to, thickness, height, reflectivity, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Box, name, x, y, heading, length, width, height, movable, mass,
                                   reflectivity, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Cylinder, name, x, y, radius, height, movable, mass, reflectivity, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Lamp, name, x, y, height, intensity, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Speaker, name, x, y, height, level, on, off, every, times, wave, tone,
                                   sweep_to, place)
inline void to_json(nlohmann::json& json, const FloorImage& image) {
    json = image.text();
}
inline void from_json(const nlohmann::json& json, FloorImage& image) {
    image = FloorImage::from_text(json.get<std::string>());
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Patch, name, shape, x, y, heading, length, width, radius, grey, image,
                                   place)
template <class Thing>
void to_json(nlohmann::json& json, const Virtual<Thing>& thing) {
    json = static_cast<const Thing&>(thing);
    json["robots"] = thing.robots;
}
template <class Thing>
void from_json(const nlohmann::json& json, Virtual<Thing>& thing) {
    static_cast<Thing&>(thing) = json.get<Thing>();
    json.at("robots").get_to(thing.robots);
}
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Pheromone, name, robots, led, radius, fill_time, half_life, diffusion,
                                   grey, cell, record_every, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VirtualBoard, name, x, y, heading, data, power, begin, every, jitter,
                                   place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(VirtualThings, walls, boxes, cylinders, lamps, pheromones, boards)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Booth, name, x, y, heading, reflectivity, signals, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Robot, name, x, y, heading, parameters, board_signals, ground_signals, rab,
                                   camera, rab_signals, place)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Recording, directory, period, log)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExtensionAxis, over, at)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ExtensionTerm, adds_to, sensor, times, over, value, sd, run_spread)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(World, node_name, file, seed, ambient_light, arena, walls, boxes,
                                   cylinders, lamps, speakers, patches, virtuals, robots, booths, parameters,
                                   extension, ircom, recording)

}  // namespace puckloop::physics
