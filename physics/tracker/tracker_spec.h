#pragma once
// What an overhead tracker is like. No single system is modelled: published ones of swarm laboratories give
// 10 to 25 frames a second, some millimetres and degrees of noise, losses at walls and markers taken for each
// other, but no rates of the latter two (docs/fidelity.md).

#include "base/fields/field.h"

#include <numbers>
#include <string_view>

namespace puckloop::physics {

struct TrackerSpec {
    double frame_rate = 10.0;
    double latency = 0.05;
    double position_noise = 0.003;
    double heading_noise = 0.035;
    double loss = 0.0;
    double edge_loss = 0.0;
    double edge = 0.1;
    double loss_time = 0.3;
    double swap = 0.0;
    double swap_distance = 0.1;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("frame_rate", &TrackerSpec::frame_rate, "seen in the first step (1 ms) that it is due")
                .in("Hz")
                .within(0.1, 1000),
            field("latency", &TrackerSpec::latency, "from there to who listens, to the millisecond")
                .in("s")
                .within(0, 10),
            field("position_noise", &TrackerSpec::position_noise, "of x and of y, standard deviation")
                .in("m")
                .within(0, 1),
            field("heading_noise", &TrackerSpec::heading_noise, "standard deviation")
                .in("rad")
                .within(0, std::numbers::pi),
            field("loss", &TrackerSpec::loss, "chance, a frame and robot, that it loses it")
                .in("1")
                .within(0, 1),
            field("edge_loss", &TrackerSpec::edge_loss,
                  "the same within `edge` of the arena's edge, if larger")
                .in("1")
                .within(0, 1),
            field("edge", &TrackerSpec::edge, "from there to the robot's middle").in("m").within(0, 100),
            field("loss_time", &TrackerSpec::loss_time, "mean time until it finds a lost robot")
                .in("s")
                .within(1e-3, 1000),
            field("swap", &TrackerSpec::swap,
                  "chance, a frame and near pair, that the two change their names")
                .in("1")
                .within(0, 1),
            field("swap_distance", &TrackerSpec::swap_distance, "between the middles of a near pair")
                .in("m")
                .within(0, 100));
    }
};
static_assert(lists_all_fields<TrackerSpec>);

}  // namespace puckloop::physics
