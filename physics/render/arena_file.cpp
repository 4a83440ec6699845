#include "physics/render/arena_file.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"

#include <fmt/format.h>

namespace puckloop::physics {

namespace {

constexpr const char* kRemedy = "the arena.json of a run: run the scenario again";

}  // namespace

void write_arena_file(World world, const std::filesystem::path& file) {
    world.recording = {};
    write_file(file, fmt::format("{{\"format\":{},\"world\":{}}}\n", kArenaFormat, to_json(world)));
}

World read_arena_file(const std::filesystem::path& file) {
    const auto text = read_whole_file(file);
    if (!text) throw InputError(file.string(), "", "cannot be read", kRemedy);
    const auto json = nlohmann::json::parse(*text, nullptr, false);
    const auto format = json.is_object() ? json.find("format") : json.end();
    if (!json.is_object() || format == json.end() || !format->is_number_integer() || !json.contains("world"))
        throw InputError(file.string(), "", "is damaged", kRemedy);
    if (*format != kArenaFormat)
        throw InputError(file.string(), "format", fmt::format("is {}", format->dump()),
                         fmt::format("{}: run the scenario again with this puckloop", kArenaFormat));
    try {
        World world = from_json(json["world"].dump());
        check(world);
        return world;
    } catch (const std::exception& error) {
        throw InputError(file.string(), "world", error.what(), kRemedy);
    }
}

}  // namespace puckloop::physics
