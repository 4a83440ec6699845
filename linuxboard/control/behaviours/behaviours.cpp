#include "linuxboard/control/behaviours/aggregate.h"
#include "linuxboard/control/behaviours/drive_to_light.h"
#include "linuxboard/control/behaviours/follow.h"
#include "linuxboard/control/behaviours/seek.h"
#include "linuxboard/control/behaviours/serve.h"

#include <cmath>

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

/// Turns on the spot and stops for a moment between two turns, when somebody may change what is around.
class Spin : public Behaviour {
    Actuators step(const Sensors& sensors, double t) override {
        constexpr double kTurn = 10.3, kStop = 0.2;  // s
        constexpr double kSpeed = 40;                // mm/s
        Actuators out;
        out.body_led = !sensors.battery_ok;
        if (std::fmod(t, kTurn + kStop) >= kTurn) return out;
        out.left_mm_s = -kSpeed;
        out.right_mm_s = kSpeed;
        return out;
    }
};

}  // namespace

std::unique_ptr<Behaviour> make_behaviour(std::string_view name, int own_id) {
    if (name == "wander") return std::make_unique<Wander>();
    if (name == "light") return std::make_unique<DriveToLight>();
    if (name == "aggregate") return std::make_unique<Aggregate>(own_id);
    if (name == "follow") return std::make_unique<Follow>(own_id);
    if (name == "seek") return std::make_unique<Seek>();
    if (name == "serve") return std::make_unique<Serve>();
    if (name == "still") return std::make_unique<Still>();
    if (name == "spin") return std::make_unique<Spin>();
    return nullptr;
}

bool needs_camera(std::string_view name) {
    return name == "seek";
}

bool needs_neighbours(std::string_view name) {
    return name == "aggregate" || name == "follow";
}

}  // namespace puckloop::control
