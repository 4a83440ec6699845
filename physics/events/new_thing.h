#pragma once
// Things by their kinds: a world and what an action adds have the same lists of them.

#include "physics/events/event.h"

namespace puckloop::physics {

/// Calls function(thing, kind) for each thing of a World (its robots are none of them) or a NewThing.
template <class Things, class Function>
void for_each_thing(Things& things, Function function) {
    const auto each = [&](auto& list, const char* kind) {
        for (auto& thing : list)
            function(thing, kind);
    };
    each(things.walls, "wall");
    each(things.boxes, "box");
    each(things.cylinders, "cylinder");
    each(things.lamps, "lamp");
    each(things.speakers, "speaker");
    each(things.patches, "floor_patch");
    each(things.virtuals.walls, "virtual_wall");
    each(things.virtuals.boxes, "virtual_box");
    each(things.virtuals.cylinders, "virtual_cylinder");
    each(things.virtuals.lamps, "virtual_lamp");
    each(things.virtuals.pheromones, "pheromone");
    each(things.virtuals.boards, "virtual_board");
}

/// The new thing in an arena with nothing else, so that check_things() judges its sizes and values.
inline World world_of(const NewThing& thing, const Arena& arena) {
    World world;
    world.arena = arena;
    world.walls = thing.walls;
    world.boxes = thing.boxes;
    world.cylinders = thing.cylinders;
    world.lamps = thing.lamps;
    world.speakers = thing.speakers;
    world.patches = thing.patches;
    world.virtuals = thing.virtuals;
    return world;
}

}  // namespace puckloop::physics
