// "NAME=NUMBER" of `gap record --set`: what is changed about the emulated robot.

#include "base/error.h"
#include "physics/description/parameters.h"
#include "tools/gap/emulate/record.h"

#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <stdexcept>

namespace puckloop::gap::emulate {

void set_parameter(Robot& robot, const std::string& assignment) {
    const auto equals = assignment.find('=');
    char* end = nullptr;
    const double value =
        equals == std::string::npos ? 0.0 : std::strtod(assignment.c_str() + equals + 1, &end);
    if (equals == std::string::npos || end == assignment.c_str() + equals + 1 || *end != '\0')
        throw InputError("", "--set", fmt::format("'{}' is not an assignment", assignment),
                         "PARAMETER=NUMBER");
    const std::string name = assignment.substr(0, equals);
    struct Own {
        const char* name;
        double* place;
        double low, high;
    };
    const std::array<Own, 14> own{{{"board.crystal_ppm", &robot.crystal_ppm, -1e4, 1e4},
                                   {"host.period", &robot.period, 0.01, 10.0},
                                   {"tracker.exposure", &robot.tracker_exposure, 0.0, 1.0},
                                   {"host.rab_poll", &robot.rab_poll, 0.0, 10.0},
                                   {"uart.factor", &robot.uart_factor, 0.5, 2.0},
                                   {"uart.loss", &robot.uart_loss, 0.0, 1.0},
                                   {"uart.delay", &robot.uart_delay, 0.0, 10.0},
                                   {"uart.cut", &robot.uart_cut, 0.0, 1.0},
                                   {"uart.cut_again", &robot.uart_cut_again, 0.0, 1.0},
                                   {"uart.edge_loss", &robot.uart_edge_loss, 0.0, 1.0},
                                   {"linux.tty_batch", &robot.lateness.tty_batch, 0.0, 1.0},
                                   {"linux.i2c_hold", &robot.lateness.i2c_hold, 0.0, 1.0},
                                   {"linux.oversleep", &robot.lateness.oversleep, -1.0, 1.0},
                                   {"linux.oversleep_jitter", &robot.lateness.oversleep_jitter, 0.0, 1.0}}};
    std::string names;
    for (const Own& known : own)
        names += fmt::format(", {}", known.name);
    for (const Own& known : own)
        if (name == known.name) {
            if (!(value >= known.low && value <= known.high))
                throw InputError("", "--set " + assignment, "is out of range",
                                 fmt::format("{:g} to {:g}", known.low, known.high));
            *known.place = value;
            return;
        }
    try {
        physics::Parameters().set(name, value);
    } catch (const std::invalid_argument& error) {
        throw InputError("", "--set " + assignment, error.what(),
                         "a parameter of `puckloop run --list-parameters`" + names);
    }
    robot.parameters[name] = value;
}

}  // namespace puckloop::gap::emulate
