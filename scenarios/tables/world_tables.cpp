#include "scenarios/tables/world_tables.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "physics/description/parameters.h"
#include "scenarios/tables/thing_tables.h"

#include <fmt/format.h>

namespace puckloop::scenarios {

namespace {

/// Calls read(reader, item, place) for each [[key]] table; names default to "key 1", "key 2".
template <typename Item, typename Read>
void read_each(Reader& top, std::string_view key, std::vector<Item>& list, Read read) {
    for (const TomlValue* table : top.tables(key)) {
        const std::string fallback = fmt::format("{} {}", key, list.size() + 1);
        Reader reader(top.file(), fallback, *table);
        Item item;
        item.name = reader.text("name", fallback);
        item.place = place_of(*table);
        read(reader, item);
        reader.finish();
        list.push_back(std::move(item));
    }
}

physics::Arena read_arena(Reader& top) {
    const TomlValue* table = top.table("arena");
    if (!table) top.fail("arena", "[arena] is missing", "[arena] with size = [\"1 m\", \"80 cm\"]");
    Reader reader(top.file(), "arena", *table);
    physics::Arena arena;
    if (reader.has("corners") == reader.has("size"))
        reader.fail("size", "give either size or corners", "size = [\"1 m\", \"80 cm\"]");
    if (reader.has("size")) {
        const auto size = reader.quantities("size", Dimension::Length, 2);
        arena = physics::rectangular_arena(size[0], size[1]);
    } else {
        for (const auto& corner : reader.quantity_lists("corners", Dimension::Length, 2))
            arena.corners.push_back({corner[0], corner[1]});
    }
    arena.walls = reader.flag("walls", arena.walls);
    arena.wall_height = reader.quantity("wall_height", Dimension::Length, arena.wall_height);
    arena.wall_thickness = reader.quantity("wall_thickness", Dimension::Length, arena.wall_thickness);
    arena.reflectivity = reader.quantity("reflectivity", Dimension::Ratio, arena.reflectivity);
    arena.floor_grey = reader.quantity("floor_grey", Dimension::Ratio, arena.floor_grey);
    arena.place = place_of(*table);
    reader.finish();
    return arena;
}

void read_parameter_level(const std::string& file, const std::string& where, const std::string& prefix,
                          const TomlValue& table, std::map<std::string, double>& result) {
    Reader reader(file, where, table);
    for (const auto& [key, value] : reader.everything()) {
        const std::string name = prefix.empty() ? key : prefix + "." + key;
        if (value.is_table()) {
            read_parameter_level(file, where, name, value, result);
            continue;
        }
        int index = -1;
        const physics::ParameterInfo* info = physics::find_parameter(name, index);
        if (!info) {
            std::vector<std::string_view> names;
            for (const auto& entry : physics::parameter_table())
                names.emplace_back(entry.name);
            const std::string meant = nearest_name(name, names);
            reader.fail(key, fmt::format("unknown parameter '{}'", name),
                        meant.empty() ? "a name that 'puckloop run --list-parameters' shows"
                                      : fmt::format("perhaps '{}'", meant));
        }
        const double number = reader.quantity(key, dimension_of(info->unit));
        if (!(number >= info->min && number <= info->max))  // nan, too
            reader.fail(key, fmt::format("{} = {} is out of range", name, number),
                        fmt::format("{} to {} {}", info->min, info->max, info->unit));
        result[name] = number;
    }
}

}  // namespace

std::map<std::string, double> read_parameters(const std::string& file, const std::string& where,
                                              const TomlValue& table) {
    std::map<std::string, double> result;
    read_parameter_level(file, where, "", table, result);
    return result;
}

Dimension dimension_of_parameter(const std::string& name) {
    int index = -1;
    const physics::ParameterInfo* info = physics::find_parameter(name, index);
    return info == nullptr ? Dimension::Number : dimension_of(info->unit);
}

std::string parameter_text(const std::string& name, double value) {
    int index = -1;
    const physics::ParameterInfo* info = physics::find_parameter(name, index);
    const Dimension dimension = dimension_of_parameter(name);
    if (dimension == Dimension::Number || dimension == Dimension::Ratio) return fmt::format("{:.17g}", value);
    return fmt::format("\"{:.17g} {}\"", value, info->unit);
}

physics::World read_world(Reader& top) {
    physics::World world;
    world.file = top.file();
    world.arena = read_arena(top);
    read_each(top, "wall", world.walls, read_wall);
    read_each(top, "box", world.boxes, read_box);
    read_each(top, "cylinder", world.cylinders, read_cylinder);
    read_each(top, "lamp", world.lamps, read_lamp);
    read_each(top, "speaker", world.speakers, read_speaker);
    read_each(top, "floor_patch", world.patches, read_patch);
    read_each(top, "virtual_wall", world.virtuals.walls, read_virtual_wall);
    read_each(top, "virtual_box", world.virtuals.boxes, read_virtual_box);
    read_each(top, "virtual_cylinder", world.virtuals.cylinders, read_virtual_cylinder);
    read_each(top, "virtual_lamp", world.virtuals.lamps, read_virtual_lamp);
    read_each(top, "virtual_board", world.virtuals.boards, read_virtual_board);
    read_each(top, "pheromone", world.virtuals.pheromones, read_pheromone);
    if (const TomlValue* table = top.table("light")) {
        Reader reader(top.file(), "light", *table);
        world.ambient_light = reader.quantity("ambient", Dimension::Ratio, world.ambient_light);
        reader.finish();
    }
    if (const TomlValue* table = top.table("parameters"))
        world.parameters = read_parameters(top.file(), "parameters", *table);
    return world;
}

}  // namespace puckloop::scenarios
