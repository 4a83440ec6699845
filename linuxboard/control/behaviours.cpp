#include "linuxboard/control/aggregate.h"
#include "linuxboard/control/drive_to_light.h"
#include "linuxboard/control/follow.h"

namespace puckloop::control {

namespace {

/// Stands still: somebody to be heard, for calibrations.
class Still : public Behaviour {
    Actuators step(const Sensors& sensors, double) override {
        Actuators out;
        out.body_led = !sensors.battery_ok;
        return out;
    }
};

}  // namespace

std::unique_ptr<Behaviour> make_behaviour(std::string_view name, int own_id) {
    if (name == "wander") return std::make_unique<Wander>();
    if (name == "light") return std::make_unique<DriveToLight>();
    if (name == "aggregate") return std::make_unique<Aggregate>(own_id);
    if (name == "follow") return std::make_unique<Follow>(own_id);
    if (name == "still") return std::make_unique<Still>();
    return nullptr;
}

bool needs_neighbours(std::string_view name) {
    return name == "aggregate" || name == "follow";
}

}  // namespace puckloop::control
