// Plans as JSON text: how they reach the world's process.

#include "base/error.h"
#include "base/plain_text.h"
#include "physics/description/description_fields.h"
#include "physics/events/event.h"

namespace nlohmann {

template <class T>
struct adl_serializer<std::optional<T>> {
    static void to_json(json& j, const std::optional<T>& value) { j = value ? json(*value) : json(nullptr); }
    static void from_json(const json& j, std::optional<T>& value) {
        value = j.is_null() ? std::nullopt : std::optional<T>(j.get<T>());
    }
};

}  // namespace nlohmann

namespace puckloop::physics {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(NewThing, walls, boxes, cylinders, lamps, speakers, patches, virtuals)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Action, verb, object, to, relative, heading, over, thing, property, value,
                                   number, address, hold, text, command, toml)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Condition, kind, robot, other, at, radius, length, width, distance, on)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Event, name, file, place, at, when, delay, every, count, action)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Computer, name, address)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EventPlan, events, computers, live, mission, repeats, journal)

std::string to_json(const EventPlan& plan) {
    return nlohmann::json(plan).dump();
}

EventPlan plan_from_json(std::string_view text) {
    try {
        return nlohmann::json::parse(text).get<EventPlan>();
    } catch (const nlohmann::json::exception& error) {
        throw InputError("", "events", reason_of(error), "JSON as to_json writes it");
    }
}

}  // namespace puckloop::physics
