#include "scenarios/thing_tables.h"

namespace puckloop::scenarios {

namespace {

void read_centre(Reader& reader, double& x, double& y) {
    const auto centre = reader.quantities("centre", Dimension::Length, 2);
    x = centre[0];
    y = centre[1];
}

/// mass makes a thing movable; without it the thing is fixed.
template <typename Item>
void read_mass(Reader& reader, Item& item) {
    const auto mass = reader.optional_quantity("mass", Dimension::Mass);
    item.movable = mass.has_value();
    if (mass) item.mass = *mass;
}

}  // namespace

void read_wall(Reader& reader, physics::Wall& wall) {
    const auto from = reader.quantities("from", Dimension::Length, 2);
    const auto to = reader.quantities("to", Dimension::Length, 2);
    wall.from = {from[0], from[1]};
    wall.to = {to[0], to[1]};
    wall.thickness = reader.quantity("thickness", Dimension::Length, wall.thickness);
    wall.height = reader.quantity("height", Dimension::Length, wall.height);
    wall.reflectivity = reader.quantity("reflectivity", Dimension::Ratio, wall.reflectivity);
}

void read_box(Reader& reader, physics::Box& box) {
    read_centre(reader, box.x, box.y);
    box.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    const auto size = reader.quantities("size", Dimension::Length, 3);
    box.length = size[0];
    box.width = size[1];
    box.height = size[2];
    read_mass(reader, box);
    box.reflectivity = reader.quantity("reflectivity", Dimension::Ratio, box.reflectivity);
}

void read_cylinder(Reader& reader, physics::Cylinder& cylinder) {
    read_centre(reader, cylinder.x, cylinder.y);
    cylinder.radius = reader.quantity("radius", Dimension::Length);
    cylinder.height = reader.quantity("height", Dimension::Length, cylinder.height);
    read_mass(reader, cylinder);
    cylinder.reflectivity = reader.quantity("reflectivity", Dimension::Ratio, cylinder.reflectivity);
}

void read_lamp(Reader& reader, physics::Lamp& lamp) {
    read_centre(reader, lamp.x, lamp.y);
    lamp.height = reader.quantity("height", Dimension::Length, lamp.height);
    lamp.intensity = reader.quantity("intensity", Dimension::Ratio, lamp.intensity);
}

void read_speaker(Reader& reader, physics::Speaker& speaker) {
    const auto position = reader.quantities("position", Dimension::Length, 2);
    speaker.x = position[0];
    speaker.y = position[1];
    speaker.height = reader.quantity("height", Dimension::Length, speaker.height);
    speaker.level = reader.quantity("level", Dimension::Number);
    speaker.on = reader.quantity("on", Dimension::Time, speaker.on);
    speaker.off = reader.quantity("off", Dimension::Time, speaker.off);
}

void read_patch(Reader& reader, physics::Patch& patch) {
    read_centre(reader, patch.x, patch.y);
    patch.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    patch.grey = reader.quantity("grey", Dimension::Ratio);
    if (reader.choice("shape", "rectangle", {"rectangle", "disc"}) == "disc") {
        patch.shape = physics::Patch::Shape::Disc;
        patch.radius = reader.quantity("radius", Dimension::Length);
    } else {
        const auto size = reader.quantities("size", Dimension::Length, 2);
        patch.length = size[0];
        patch.width = size[1];
    }
}

}  // namespace puckloop::scenarios
