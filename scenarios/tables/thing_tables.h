#pragma once
// One thing in the world from its table: [[wall]], [[box]], [[cylinder]], [[lamp]], [[speaker]],
// [[floor_patch]], their virtual kinds and [[pheromone]], or what an event adds. Names and places are the
// caller's.

#include "physics/description/description.h"
#include "scenarios/values/reader.h"

#include <string>

namespace puckloop::scenarios {

void read_wall(Reader& reader, physics::Wall& wall);
void read_box(Reader& reader, physics::Box& box);
void read_cylinder(Reader& reader, physics::Cylinder& cylinder);
void read_lamp(Reader& reader, physics::Lamp& lamp);
void read_speaker(Reader& reader, physics::Speaker& speaker);
void read_patch(Reader& reader, physics::Patch& patch);
void read_virtual_wall(Reader& reader, physics::Virtual<physics::Wall>& wall);
void read_virtual_box(Reader& reader, physics::Virtual<physics::Box>& box);
void read_virtual_cylinder(Reader& reader, physics::Virtual<physics::Cylinder>& cylinder);
void read_virtual_lamp(Reader& reader, physics::Virtual<physics::Lamp>& lamp);
/// The key `led`: one of a robot's, as its board's signals name them.
std::string read_led(Reader& reader);
void read_virtual_board(Reader& reader, physics::VirtualBoard& board);
void read_pheromone(Reader& reader, physics::Pheromone& pheromone);

}  // namespace puckloop::scenarios
