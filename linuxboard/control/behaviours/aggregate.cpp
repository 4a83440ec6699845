#include "linuxboard/control/behaviours/aggregate.h"

#include "linuxboard/control/behaviours/steering.h"

#include <algorithm>

namespace puckloop::control {

namespace {

constexpr double kAggregateCruise = 80.0;    // mm/s
constexpr double kArrived = 12.0;            // cm: beside the other
constexpr double kLeft = 20.0;               // cm: not beside it any more
constexpr double kNeighbourTouching = 45.0;  // cm: what is felt in its direction may be the neighbour
constexpr std::uint8_t kClusterLeds = 0xFF;

bool nearer(const Neighbour& a, const Neighbour& b) {
    return a.range_cm < b.range_cm;
}

}  // namespace

bool Aggregate::beside(const Neighbour& neighbour) const {
    return neighbour.range_cm < (in_group_ ? kLeft : kArrived) ||
           (neighbour.range_cm < kNeighbourTouching && touches(wander_.above_offset(), neighbour.bearing));
}

/// The neighbour to go to: of a better group if there is one, otherwise the nearest.
const Neighbour* Aggregate::destination(const std::vector<Neighbour>& neighbours) const {
    std::uint32_t own_size = 0;
    int lowest_id = own_id_;
    for (const Neighbour& one : neighbours) {
        if (!beside(one)) continue;
        ++own_size;
        lowest_id = std::min(lowest_id, one.id);
    }
    const Neighbour* best = nullptr;
    for (const Neighbour& one : neighbours) {
        if (own_size == 0 || beside(one) || one.data < own_size) continue;
        if (one.data == own_size && one.id > lowest_id) continue;
        if (best == nullptr || nearer(one, *best)) best = &one;
    }
    if (best != nullptr || neighbours.empty()) return best;
    return &*std::min_element(neighbours.begin(), neighbours.end(), nearer);
}

Actuators Aggregate::step(const Sensors& sensors, double t) {
    Actuators out = wander_.step(sensors, t);
    const auto size = std::count_if(sensors.neighbours.begin(), sensors.neighbours.end(),
                                    [this](const Neighbour& one) { return beside(one); });
    const Neighbour* goal = destination(sensors.neighbours);
    in_group_ = goal != nullptr && beside(*goal);
    if (in_group_) {
        out = Actuators{};
        out.ring_leds = kClusterLeds;
    } else if (goal != nullptr && !wander_.avoiding()) {
        out = drive_towards(goal->bearing, kAggregateCruise);
        out.ring_leds = led_towards(goal->bearing);
    }
    out.body_led = !sensors.battery_ok;
    out.say = static_cast<std::uint32_t>(size);
    return out;
}

}  // namespace puckloop::control
