#include "linuxboard/control/aggregate.h"
#include "linuxboard/control/drive_to_light.h"
#include "linuxboard/control/follow.h"

namespace puckloop::control {

std::unique_ptr<Behaviour> make_behaviour(std::string_view name, int own_id) {
    if (name == "wander") return std::make_unique<Wander>();
    if (name == "light") return std::make_unique<DriveToLight>();
    if (name == "aggregate") return std::make_unique<Aggregate>(own_id);
    if (name == "follow") return std::make_unique<Follow>(own_id);
    return nullptr;
}

bool needs_neighbours(std::string_view name) {
    return name == "aggregate" || name == "follow";
}

}  // namespace puckloop::control
