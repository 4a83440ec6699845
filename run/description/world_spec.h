#pragma once
// The world of a run, with what happens to it.

#include "base/fields/field.h"
#include "physics/description/world_form.h"
#include "physics/events/event.h"
#include "physics/tracker/tracker_spec.h"
#include "run/mission/mission_program_spec.h"

#include <optional>
#include <string>
#include <string_view>

namespace puckloop::tools {

struct EventsForm {
    static JsonValue write(const physics::EventPlan& events);
    static void read(physics::EventPlan& events, const JsonValue& from, const std::string& place);
};

struct WorldSpec {
    static constexpr std::string_view kKind = "world";

    physics::World world{};
    physics::EventPlan events{};
    std::string control{};
    bool bluetooth = false;
    bool wifi = false;
    std::optional<physics::TrackerSpec> tracker{};
    std::optional<MissionProgramSpec> mission{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("world", &WorldSpec::world, "robots, walls and light").required().as<physics::WorldForm>(),
            field("events", &WorldSpec::events, "what happens to it").required().as<EventsForm>(),
            field("control", &WorldSpec::control, "socket at which commands come; empty: none")
                .not_in(Comparison::Run),
            field("bluetooth", &WorldSpec::bluetooth, "there is a port for Bluetooth's medium"),
            field("wifi", &WorldSpec::wifi, "there is a port for a wireless network"),
            field("tracker", &WorldSpec::tracker, "above the arena; a mission program needs one"),
            field("mission", &WorldSpec::mission, "program that judges the run"));
    }
};
static_assert(lists_all_fields<WorldSpec>);

}  // namespace puckloop::tools
