#include "gap/emulate/secrets.h"

namespace puckloop::gap::emulate {

const std::vector<Secret>& secrets() {
    static const std::vector<Secret> list{
        {"motion", "nothing", {}, {}},
        {"motion",
         "wheels 0.6 % larger",
         {"robot.wheel_radius_left=0.020623", "robot.wheel_radius_right=0.020623"},
         {"wheel_scale"}},
        {"motion",
         "right wheel 0.5 % larger, left one smaller",
         {"robot.wheel_radius_left=0.0203975", "robot.wheel_radius_right=0.0206025"},
         {"wheel_mismatch"}},
        {"motion", "axle 2 % longer", {"robot.axle_length=0.05406"}, {"axle_length"}},
        {"motion", "play of 3 degrees in the gears", {"robot.backlash=0.052"}, {"backlash"}},
        {"motion",
         "slippery floor, mu 0.06",
         {"contact.mu=0.06", "contact.mu_lateral=0.06"},
         {"acceleration_slip"}},
        {"motion",
         "steps lost above 850 steps/s",
         {"robot.step_loss_speed=850", "robot.step_loss_width=40"},
         {"step_loss"}},
        {"motion", "commands 40 ms late on the serial line", {"uart.delay=0.04"}, {"command_latency"}},
        {"proximity", "nothing", {}, {}},
        {"proximity", "gain of sensor 3 up by 20 %", {"proximity.gain3=1.2"}, {"sensor_gain"}},
        {"proximity", "offset of sensor 5 up by 20 counts", {"proximity.offset5=83"}, {"sensor_offset"}},
        {"proximity",
         "4 % crosstalk between neighbours",
         {"proximity.neighbour_crosstalk=0.04"},
         {"crosstalk"}},
        {"proximity", "sensor 1 turned by 6 degrees", {"proximity.direction1=-0.6964"}, {"sensor_direction"}},
        {"proximity", "emitters 10 % weaker", {"proximity.scale=0.9"}, {"sensor_gain", "reflectivity"}},
        {"ground", "nothing", {}, {}},
        {"ground", "gain of the centre sensor down by 8 %", {"ground.gain1=0.92"}, {"ground_gain"}},
        {"ground", "left sensor 25 counts up", {"ground.offset0=25"}, {"ground_gain"}},
        {"ground", "black reads 400 in place of 329", {"ground.black=400"}, {"ground_gain"}},
        {"timing", "nothing", {}, {}},
        {"timing", "control period 104 ms", {"host.period=0.104"}, {"long_period", "clock_drift"}},
        {"timing", "one byte of 3000 lost", {"uart.loss=0.00033"}, {"truncation"}},
        {"rab", "nothing", {}, {}},
        {"rab", "gain of receiver 4 up by 30 %", {"ir.receiver_gain3=1.3"}, {"strength_spread_parts"}},
        {"rab", "emitters' lobe cos^2 in place of cos", {"ir.emitter_exponent=2"}, {"rab_lobe"}},
        {"rab", "receivers' lobe cos in place of its root", {"ir.receiver_exponent=1"}, {"rab_lobe"}},
        {"rab", "boards polled every 60 ms, a message each", {"host.rab_poll=0.06"}, {"poll_loss"}},
        {"serial", "nothing", {}, {}},
        {"serial", "main board's crystal 120 ppm slow", {"board.crystal_ppm=-120"}, {"clock_drift"}},
        {"serial", "baud rate 0.6 % high, by the crystal", {"board.crystal_ppm=6000"}, {"clock_drift"}},
    };
    return list;
}

}  // namespace puckloop::gap::emulate
