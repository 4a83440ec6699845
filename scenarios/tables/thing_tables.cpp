#include "scenarios/tables/thing_tables.h"

#include "scenarios/values/png_floor.h"

#include <fmt/format.h>

#include <cmath>

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
    const double duration = reader.quantity("duration", Dimension::Time, 0.0);
    speaker.off =
        reader.quantity("off", Dimension::Time, duration > 0.0 ? speaker.on + duration : speaker.off);
    if (duration > 0.0 && reader.has("off")) reader.fail("off", "duration is given as well", "one of them");
    speaker.every = reader.quantity("every", Dimension::Time, 0.0);
    constexpr std::int64_t kMost = 1'000'000;
    speaker.times = static_cast<std::uint64_t>(reader.integer("times", 0, 0, kMost));
    const std::string wave = reader.text("wave", "none");
    if (wave != "none" && wave != "noise")
        reader.fail("wave", fmt::format("there is no wave '{}'", wave), "noise or none; a tone by tone");
    speaker.wave = wave == "noise";
    speaker.tone = reader.quantity("tone", Dimension::Frequency, 0.0);
    speaker.sweep_to = reader.quantity("sweep_to", Dimension::Frequency, 0.0);
    const bool ends = duration > 0.0 || reader.has("off");
    const auto needs = [&](const char* key, bool given, const char* other, bool there) {
        if (given && !there) reader.fail(key, fmt::format("has no meaning without {}", other), other);
    };
    needs("sweep_to", speaker.sweep_to > 0.0, "tone", speaker.tone > 0.0);
    needs("sweep_to", speaker.sweep_to > 0.0, "duration", ends);
    needs("every", speaker.every > 0.0, "duration", ends);
    needs("times", speaker.times > 0, "every", speaker.every > 0.0);
}

void read_patch(Reader& reader, physics::Patch& patch) {
    read_centre(reader, patch.x, patch.y);
    patch.heading = reader.quantity("heading", Dimension::Angle, 0.0);
    const std::string image = reader.text("image", "");
    patch.grey = image.empty() ? reader.quantity("grey", Dimension::Ratio) : 0.0;
    if (!image.empty()) {
        for (const char* other : {"grey", "shape", "radius"})
            if (reader.has(other))
                reader.fail(other, fmt::format("a patch with an image has no {}", other),
                            "image, centre, size, heading, stretch");
        const auto size = reader.quantities("size", Dimension::Length, 2);
        patch.length = size[0];
        patch.width = size[1];
        patch.image = read_png(reader.folder() / image);
        const bool stretch = reader.flag("stretch", false);
        if (const std::string problem = misfit_of(patch.image, patch.length, patch.width);
            !stretch && !problem.empty())
            reader.fail("size", problem, "the image's proportions, or stretch = true");
        return;
    }
    if (reader.choice("shape", "rectangle", {"rectangle", "disc"}) == "disc") {
        patch.shape = physics::Patch::Shape::Disc;
        patch.radius = reader.quantity("radius", Dimension::Length);
    } else {
        const auto size = reader.quantities("size", Dimension::Length, 2);
        patch.length = size[0];
        patch.width = size[1];
    }
}

namespace {

/// As the real thing, which `read` reads, and who senses it.
template <class Thing>
void read_virtual(Reader& reader, physics::Virtual<Thing>& thing, void (*read)(Reader&, Thing&)) {
    read(reader, thing);
    thing.robots = reader.texts("robots");
}

void refuse_mass(Reader& reader, const char* what) {
    if (reader.has("mass"))
        reader.fail("mass", fmt::format("a virtual {} has none: nothing pushes it", what));
}

}  // namespace

void read_virtual_wall(Reader& reader, physics::Virtual<physics::Wall>& wall) {
    read_virtual(reader, wall, read_wall);
}

void read_virtual_box(Reader& reader, physics::Virtual<physics::Box>& box) {
    refuse_mass(reader, "box");
    read_virtual(reader, box, read_box);
}

void read_virtual_cylinder(Reader& reader, physics::Virtual<physics::Cylinder>& cylinder) {
    refuse_mass(reader, "cylinder");
    read_virtual(reader, cylinder, read_cylinder);
}

void read_virtual_lamp(Reader& reader, physics::Virtual<physics::Lamp>& lamp) {
    read_virtual(reader, lamp, read_lamp);
}

std::string read_led(Reader& reader) {
    return reader.choice(
        "led", "", {"led0", "led1", "led2", "led3", "led4", "led5", "led6", "led7", "led_front", "led_body"});
}

void read_virtual_board(Reader& reader, physics::VirtualBoard& board) {
    const auto position = reader.quantities("position", Dimension::Length, 2);
    board.x = position[0];
    board.y = position[1];
    board.heading = reader.quantity("heading", Dimension::Angle, board.heading);
    constexpr double kHighest = 255;
    for (const double byte : reader.bare_numbers("data")) {
        if (!(byte >= 0 && byte <= kHighest) || byte != std::floor(byte))
            reader.fail("data", fmt::format("{} is not a byte", byte), "1 to 4 whole numbers, 0 to 255");
        board.data.push_back(static_cast<std::uint8_t>(byte));
    }
    if (board.data.empty() || board.data.size() > 4)
        reader.fail("data", fmt::format("{} bytes", board.data.size()), "1 to 4 whole numbers, 0 to 255");
    board.power = reader.quantity("power", Dimension::Number, board.power);
    board.begin = reader.quantity("begin", Dimension::Time, board.begin);
    board.every = reader.quantity("every", Dimension::Time, board.every);
    board.jitter = reader.quantity("jitter", Dimension::Time, board.jitter);
}

void read_pheromone(Reader& reader, physics::Pheromone& pheromone) {
    pheromone.robots = reader.texts("robots");
    if (reader.has("led")) pheromone.led = read_led(reader);
    pheromone.radius = reader.quantity("radius", Dimension::Length, pheromone.radius);
    pheromone.fill_time = reader.quantity("fill_time", Dimension::Time, pheromone.fill_time);
    pheromone.half_life = reader.quantity("half_life", Dimension::Time, pheromone.half_life);
    pheromone.diffusion = reader.quantity("diffusion", Dimension::Number, pheromone.diffusion);
    pheromone.grey = reader.quantity("grey", Dimension::Ratio, pheromone.grey);
    pheromone.cell = reader.quantity("cell", Dimension::Length, pheromone.cell);
    pheromone.record_every = reader.quantity("record_every", Dimension::Time, pheromone.record_every);
}

}  // namespace puckloop::scenarios
