#include "gap/effects/list.h"

namespace puckloop::gap {

Effect command_latency() {
    return {
        .name = "command_latency",
        .number = 11,
        .title = "commands take effect late",
        .mechanism = "Radio, serial line and control loop delay a command.",
        .equation = "motion(t) = command(t - tau)",
        .kinds = {Kind::Motion},
        .parameters = {{"command.latency",
                        -0.02,
                        0.6,
                        0.08,
                        {0.05, 0.15},
                        "20..150 ms and jitter; 0.11 rad a manoeuvre over Bluetooth"}},
        .needs = {"cmd_left"},
        .observables = "steps, way along, heading",
        .enters = "the overlay's [uart] command_delay",
        .confounded = {"tracker_delay", "wheel_scale"},
        .separated_by = "log the step counters beside the commands, or the time a command is sent and one it "
                        "takes effect",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
