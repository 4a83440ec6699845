// The world as JSON text: how a node's description reaches its process.

#include "base/error.h"
#include "base/plain_text.h"
#include "physics/description/description_fields.h"
#include "physics/description/world_form.h"

namespace puckloop::physics {

std::string to_json(const World& world) {
    return nlohmann::json(world).dump();
}

World from_json(std::string_view text) {
    try {
        return nlohmann::json::parse(text).get<World>();
    } catch (const nlohmann::json::exception& error) {
        throw InputError("", "", "world description: " + reason_of(error), "JSON as to_json writes it");
    }
}

JsonValue WorldForm::write(const World& world) {
    return parse_json(to_json(world));
}

void WorldForm::read(World& world, const JsonValue& from, const std::string& /*place*/) {
    world = from_json(dump(from));
}

}  // namespace puckloop::physics
