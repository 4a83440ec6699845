// The table of physical parameters. Sources: [W] Webots e-puck model (cyberbotics/webots), [A] ARGoS e-puck
// plugin (demiurge-project/argos3-epuck), [L] GCtronic e-puck library, [E] Enki, [M] measured on real robots
// (public logs), [S] the published e-puck descriptions, [O] ODE practice, [R] firmware and documents of the
// range-and-bearing board, [I] IRIDIA's published strength statistics of that board. "?" = plausible, no
// source found.

#include "physics/description/parameters.h"
#include "physics/description/robot_constants.h"

namespace puckloop::physics {

namespace {

#define AT(member) [](Parameters& p) { return &p.member; }
#define FIRST(member) [](Parameters& p) { return p.member.data(); }

/// 15 50 75 105 133 159 -165 -135 -105 -77 -50 -15 degrees.
const std::vector<double> kBoardAngles{.261799,   .872665,   1.308997,  1.832596,  2.321288, 2.775074,
                                       -2.879793, -2.356194, -1.832596, -1.343904, -.872665, -.261799};

std::vector<ParameterInfo> build_table() {
    // clang-format off
    return {
        // Body and drive.
        {"robot.radius", "m", 1, {kBodyRadius}, 0.02, 0.06, AT(robot.radius), "[A]; bare robot with light ring 0.037 [W]"},
        {"robot.height", "m", 1, {0.076}, 0.04, 0.2, AT(robot.height), "[A] with Linux board and turret; bare 0.045"},
        {"robot.mass", "kg", 1, {0.15}, 0.08, 0.8, AT(robot.mass), "[W]; 0.4 in ARGoS"},
        {"robot.com_x", "m", 1, {0.0}, -0.01, 0.01, AT(robot.com_x), "[W] centre of mass, forward of the axle"},
        {"robot.com_z", "m", 1, {0.015}, 0.005, 0.05, AT(robot.com_z), "[W] centre of mass above the floor"},
        {"robot.inertia_x", "kg m2", 1, {9.79e-5}, 1e-5, 2e-3, AT(robot.inertia_x), "[W]"},
        {"robot.inertia_y", "kg m2", 1, {8.64e-5}, 1e-5, 2e-3, AT(robot.inertia_y), "[W]"},
        {"robot.inertia_z", "kg m2", 1, {8.75e-5}, 1e-5, 2e-3, AT(robot.inertia_z), "[W]"},
        {"robot.reflectivity", "1", 1, {0.6}, 0.0, 2.0, AT(robot.reflectivity), "? translucent body as others see it"},
        {"robot.wheel_radius_left", "m", 1, {kWheelRadius}, 0.015, 0.026, AT(robot.wheel_radius_left), "[A,S] 41 mm diameter; 20.0 [W], wear +-0.3 mm ?"},
        {"robot.wheel_radius_right", "m", 1, {kWheelRadius}, 0.015, 0.026, AT(robot.wheel_radius_right), "as left"},
        {"robot.axle_length", "m", 1, {kAxleLength}, 0.045, 0.06, AT(robot.axle_length), "[A] contact to contact; 51 [E], 52 [W]"},
        {"robot.wheel_mass", "kg", 1, {0.005}, 0.001, 0.02, AT(robot.wheel_mass), "[W]"},
        {"robot.skid_distance", "m", 1, {0.028}, 0.01, 0.05, AT(robot.skid_distance), "? body skids before and behind the axle"},
        {"robot.skid_clearance", "m", 1, {0.0002}, 0.0, 0.003, AT(robot.skid_clearance), "? skids above the floor when level"},
        {"robot.pitch_damping", "N m s", 1, {2e-3}, 0.0, 1e-2, AT(robot.pitch_damping), "? rocking dies within a swing"},
        {"robot.steps_per_turn", "1", 1, {kStepsPerTurn}, 100, 10000, AT(robot.steps_per_turn), "[L] 20 steps x 50:1 gear"},
        {"robot.stall_torque", "N m", 1, {0.02}, 0.001, 0.1, AT(robot.stall_torque), "? 0.005-0.02 at the wheel"},
        {"robot.drive_compliance", "s", 1, {0.004}, 0.001, 0.1, AT(robot.drive_compliance), "? time constant of wheel behind rotor"},
        {"robot.settle_time", "s", 1, {0.008}, 0.0005, 0.02, AT(robot.settle_time), "? duration of one single step: a small stepper swings at about 100 Hz, damped by the gear"},
        {"robot.smoothing_limit", "s", 1, {0.02}, 0.001, 0.1, AT(robot.smoothing_limit), "? steps further apart are single steps"},
        {"robot.pull_out_steps", "steps", 1, {2.0}, 1.0, 100.0, AT(robot.pull_out_steps), "four-phase stepper: the rotor falls to the next pole pair beyond 2 steps"},
        {"robot.backlash", "rad", 1, {0.0}, 0.0, 0.1, AT(robot.backlash), "? gearbox play at the wheel, 0.5-2 deg real"},
        {"robot.step_loss_speed", "steps/s", 1, {0.0}, 0.0, 2000, AT(robot.step_loss_speed), "? half of the step groups lost at this speed; 0 = never; real 700-1000"},
        {"robot.step_loss_width", "steps/s", 1, {50}, 1, 500, AT(robot.step_loss_width), "? 30-100"},
        {"robot.deadband", "steps/s", 1, {0.0}, 0.0, 500, AT(robot.deadband), "slower steps do not move the rotor: static friction; near 0 for a good stepper"},
        {"robot.load", "kg", 1, {0.0}, 0.0, 1.0, AT(robot.load), "carried over the axle, as a disc of the body's radius at the height of com_z"},
        {"robot.turn_scrub", "1", 1, {0.0}, -0.05, 3.0, AT(robot.turn_scrub), "share by which a spot turn is too small (L longer), less in wide turns; 0-0.04, 0.007 measured [M]"},
        {"robot.load_creep", "1/kg", 1, {0.0}, -0.1, 1.0, AT(robot.load_creep), "? share of the way lost a kilogram of robot.load; 0-3 % of travel"},
        {"robot.slope_creep", "1/rad", 1, {0.0}, -0.5, 1.0, AT(robot.slope_creep), "? share of the way lost a radian that the floor rises along the heading"},
        {"robot.drift_x", "m/s", 1, {0.0}, -0.05, 0.05, AT(robot.drift_x), "? a cable's or tilted floor's pull while the wheels are driven, in the world's axes"},
        {"robot.drift_y", "m/s", 1, {0.0}, -0.05, 0.05, AT(robot.drift_y), "as drift_x"},

        // Pushes by hands and collisions that are not in the scenario.
        {"push.rate", "1/s", 1, {0.0}, 0.0, 1.0, AT(push.rate), "pushes a second, at random; 0: none"},
        {"push.size", "m", 1, {0.02}, 0.0, 0.2, AT(push.size), "standard deviation of a push in x and in y; mm to cm"},
        {"push.turn", "rad", 1, {0.0}, 0.0, 3.0, AT(push.turn), "standard deviation of the turn that comes with it"},

        // Infra-red proximity.
        {"proximity.gain", "1", 8, {1.0}, 0.0, 5.0, FIRST(proximity.gain), "[M] spread between sensors 1.08-1.65"},
        {"proximity.offset", "counts", 8, {52, 47, 60, 55, 49, 63, 58, 45}, -500, 1000, FIRST(proximity.offset), "e-puck practice: uncalibrated idle 40-300, removed by calibration"},
        {"proximity.x", "m", 8, {.030, .022, 0, -.030, -.030, 0, .022, .030}, -0.06, 0.06, FIRST(proximity.x), "[W]"},
        {"proximity.y", "m", 8, {-.010, -.025, -.031, -.015, .015, .031, .025, .010}, -0.06, 0.06, FIRST(proximity.y), "[W]"},
        {"proximity.direction", "rad", 8, {-.30020, -.80111, -1.57080, -2.64417, 2.63894, 1.57080, .79936, .29845}, -3.2, 3.2, FIRST(proximity.direction), "[W] -17.2 -45.9 -90 -151.5 151.2 90 45.8 17.1 deg; tables differ by 9 deg"},
        {"proximity.height", "m", 1, {0.0335}, 0.0, 0.1, AT(proximity.height), "[W,A] 0.030-0.037"},
        {"proximity.curve", "choice", 1, {0}, 0, 2, AT(proximity.curve), "0 table measured on a robot [W]; 1 saturating power law [M]; 2 exponential [E]"},
        {"proximity.amplitude", "counts", 1, {4.17e5}, 1, 1e7, AT(proximity.amplitude), "curve 1: A in A/(d+d0)^p, d in mm; [M] 1.2e5-4.2e5. Curve 2: counts at contact"},
        {"proximity.origin", "m", 1, {0.0099}, 0.0, 0.1, AT(proximity.origin), "curve 1: d0, 3-10 mm [M]; curve 2: decay length"},
        {"proximity.exponent", "1", 1, {2.0}, 0.5, 4.0, AT(proximity.exponent), "curve 1: p, 1.5-2.5 [M]"},
        {"proximity.saturation", "counts", 1, {4095}, 500, 10000, AT(proximity.saturation), "curves 1, 2: S in 1/(1/S+1/y); [M] 3500-5000"},
        {"proximity.scale", "1", 1, {1.0}, 0.0, 5.0, AT(proximity.scale), "emitter power: common factor"},
        {"proximity.reach", "m", 1, {0.12}, 0.02, 0.5, AT(proximity.reach), "[M] about 20 counts at 10 cm, [E] 12 cm"},
        {"proximity.rays", "1", 1, {5}, 1, 64, AT(proximity.rays), "rays a sensor, evenly over the aperture"},
        {"proximity.aperture", "rad", 1, {0.1}, 0.0, 1.5, AT(proximity.aperture), "[W] full angle"},
        {"proximity.incidence_exponent", "1", 1, {1.0}, 0.0, 4.0, AT(proximity.incidence_exponent), "cos^m of incidence, m 1..2"},
        {"proximity.pair_crosstalk", "1", 1, {0.0}, 0.0, 0.2, AT(proximity.pair_crosstalk), "? share of sensor i+-4, lit by the same pulse; .01-.05"},
        {"proximity.neighbour_crosstalk", "1", 1, {0.0}, 0.0, 0.2, AT(proximity.neighbour_crosstalk), "? share of each neighbour; .02"},
        {"proximity.warmup_gain", "1", 1, {0.0}, -0.3, 0.3, AT(proximity.warmup_gain), "[M] drift -.1..+.1"},
        {"proximity.warmup_time", "s", 1, {300}, 1, 3600, AT(proximity.warmup_time), "[M] 2-10 min"},

        {"proximity.compression", "1/counts", 1, {0.0}, 0.0, 1e-3, AT(proximity.compression), "y/(1+c y), any curve; 0 = none; [M] saturation at 3500-5000 counts"},
        {"proximity.extra_exponent", "1", 1, {0.0}, -1.5, 1.5, AT(proximity.extra_exponent), "any curve falls by ((d+d0)/(30 mm+d0))^-q more; [M] p 1.5-2.5"},
        {"proximity.distance_shift", "m", 1, {0.0}, -0.02, 0.02, AT(proximity.distance_shift), "effective origin: added to every distance; 3-10 mm between tables [M]"},
        {"proximity.threshold", "counts", 1, {0.0}, 0.0, 2000, AT(proximity.threshold), "below this a reading is 0; [M] 1060 on another robot"},
        {"proximity.ambient_offset", "counts", 1, {0.0}, -500, 500, AT(proximity.ambient_offset), "counts that room light at level 1 adds; [M] 60-140"},
        {"proximity.ambient_gain", "1", 1, {0.0}, -0.5, 0.9, AT(proximity.ambient_gain), "share of the answer lost at ambient level 1: the transistor nears its rail"},
        {"proximity.battery_gain", "1/V", 1, {0.0}, -1.0, 1.0, AT(proximity.battery_gain), "? emitter power a volt of battery, about 3.7 V"},
        {"proximity.motor_sag", "1", 1, {0.0}, 0.0, 0.2, AT(proximity.motor_sag), "? share of the whole reading lost with both motors stepping (reference sag), 0-0.02"},
        {"proximity.age", "s", 1, {0.0}, 0.0, 0.5, AT(proximity.age), "what is reflected shows this much later, beside the firmware's own schedule (0-16 ms)"},
        {"proximity.flicker", "counts", 1, {0.0}, 0.0, 300, AT(proximity.flicker), "amplitude on the reading at ambient level 1; [M] 2-30 counts"},
        {"proximity.flicker_frequency", "Hz", 1, {1.0}, 0.01, 400, AT(proximity.flicker_frequency), "of the lamp, or of the alias that the readings show; phases by the run's seed"},
        {"proximity.interference_rate", "1", 1, {0.0}, 0.0, 0.6, AT(proximity.interference_rate), "[M] share of samples that a foreign pulse hits, .02-.2"},
        {"proximity.interference_size", "counts", 1, {100}, 0.0, 2000, AT(proximity.interference_size), "mean height of a foreign pulse, up or down alike; scatter 0.3 of it"},
        {"proximity.interference_share", "1", 8, {1.0}, 0.0, 1.0, FIRST(proximity.interference_share), "share of the foreign pulses that this sensor is exposed to"},
        {"proximity.still_noise", "counts", 1, {2.83}, 0.0, 100, AT(proximity.still_noise), "scatter of a reading at rest, which motor_noise multiplies; not added itself: dark and lit sample with the board's adc_noise of 2"},
        {"proximity.motor_noise", "1", 1, {0.0}, 0.0, 20, AT(proximity.motor_noise), "scatter grows by this share of still_noise at a mean rate of 1000 steps/s; [M] .2-1 at 800"},
        {"proximity.proportional_noise", "1", 1, {0.0}, 0.0, 0.6, AT(proximity.proportional_noise), "scatter as a share of the reading, each ms anew; 0.002-0.05 in a published table, about 0 [M]"},
        {"proximity.ambient_noise", "counts", 1, {0.0}, 0.0, 200, AT(proximity.ambient_noise), "? scatter at ambient level 1, with its root; each ms anew"},

        // Ambient light.
        {"light.gain", "1", 8, {1.0}, 0.0, 5.0, FIRST(light.gain), "as proximity.gain"},
        {"light.offset", "counts", 8, {0.0}, -1000, 1000, FIRST(light.offset), "spread in a room 3450-3860"},
        {"light.dark", "counts", 1, {4000}, 2000, 4095, AT(light.dark), "e-puck practice: dark about 4000"},
        {"light.span", "counts", 1, {3600}, 0, 4095, AT(light.span), "counts lost at full light"},
        {"light.room", "1", 1, {0.0833}, 0.0, 1.0, AT(light.room), "share of the span at ambient level 1: 3700 counts"},
        {"light.decay", "1/m", 1, {2.0}, 0.0, 20.0, AT(light.decay), "[A] exp(-2 d)"},
        {"light.range", "m", 1, {2.5}, 0.1, 50.0, AT(light.range), "[A]"},
        {"light.flicker", "1", 1, {0.0}, 0.0, 0.5, AT(light.flicker), "mains flicker of the room light, share; [M] 2-30 counts"},
        {"light.flicker_frequency", "Hz", 1, {100}, 1, 400, AT(light.flicker_frequency), "twice the mains frequency"},

        // Ground.
        {"ground.gain", "1", 3, {1.0}, 0.0, 3.0, FIRST(ground.gain), "[M] three sensors on one grey: 450/520/600"},
        {"ground.offset", "counts", 3, {0.0}, -500, 500, FIRST(ground.offset), "[M] black 81..677 between robots"},
        {"ground.y", "m", 3, {0.0105, 0.0, -0.0105}, -0.05, 0.05, FIRST(ground.y), "CAD of the robot; 9 [A], 10 [W] mm"},
        {"ground.x", "m", 1, {0.030}, -0.05, 0.05, AT(ground.x), "[A,W]"},
        {"ground.height", "m", 1, {0.0015}, 0.0, 0.01, AT(ground.height), "1-2 mm"},
        {"ground.black", "counts", 1, {329}, 0, 1023, AT(ground.black), "[M] 329+-112"},
        {"ground.white", "counts", 1, {953}, 0, 1023, AT(ground.white), "[M] 953+-45"},
        {"ground.saturation", "counts", 1, {967}, 100, 1023, AT(ground.saturation), "[M] 960-975"},
        {"ground.height_slope", "1/m", 1, {43.75}, 0.0, 500, AT(ground.height_slope), "[W] 1000 at 0 mm, 300 at 16 mm"},
        {"ground.footprint", "m", 1, {0.004}, 0.0, 0.02, AT(ground.footprint), "3-6 mm"},
        {"ground.ambient", "counts", 1, {30}, 0, 1023, AT(ground.ambient), "? ambient registers under the robot at ambient level 1"},
        {"ground.noise", "counts", 1, {1.5}, 0.0, 100, AT(ground.noise), "[M] standard deviation 1-3 on white, 20 on black (texture)"},
        {"ground.period", "s", 1, {0.01}, 0.001, 1.0, AT(ground.period), "? the board samples faster than the 0.1 s of the control loop"},
        {"ground.lag", "s", 1, {0.0}, 0.0, 1.0, AT(ground.lag), "the grey under the row shows this much later; [M] 18 of 37 samples of pitch"},
        {"ground.acceleration_tilt", "rad s2/m", 1, {0.0}, -1.0, 1.0, AT(ground.acceleration_tilt), "? nose up by forward acceleration over the last 0.1 s, beside the body's own pitch"},
        {"ground.warmup_gain", "1", 1, {0.0}, -0.6, 0.6, AT(ground.warmup_gain), "[M] -67 to -114 counts in 200 s"},
        {"ground.warmup_time", "s", 1, {300}, 1, 3600, AT(ground.warmup_time), "? as proximity.warmup_time"},

        // Accelerometer.
        {"accelerometer.bias", "counts", 3, {0.0}, -500, 500, FIRST(accelerometer.bias), "zero 2048+-100"},
        {"accelerometer.scale", "1", 3, {1.0}, 0.5, 1.6, FIRST(accelerometer.scale), "of each axis, beside accelerometer.gain; [M] 744-800 counts a g"},
        {"accelerometer.zero", "counts", 1, {2048}, 0, 4095, AT(accelerometer.zero), "mid scale"},
        {"accelerometer.gain", "counts", 1, {800}, 100, 2000, AT(accelerometer.gain), "counts for 1 g, 744-800"},
        {"accelerometer.bandwidth", "Hz", 1, {150}, 1, 480, AT(accelerometer.bandwidth), "about 150 Hz"},
        {"accelerometer.turn", "rad", 1, {0.0}, -0.6, 0.6, AT(accelerometer.turn), "? chip turned on its board"},
        {"accelerometer.motor_sag", "1", 1, {0.0}, -0.05, 0.3, AT(accelerometer.motor_sag), "? share of the whole value lost with both motors stepping (reference sag), 0-0.02"},
        {"accelerometer.vibration", "counts", 1, {0.0}, 0.0, 1000, AT(accelerometer.vibration), "sd at a mean rate of 1000 steps/s, in proportion, each ms anew; [M] gyroscope's sd 640 while driving"},
        {"accelerometer.warmup", "counts", 1, {0.0}, -500, 500, AT(accelerometer.warmup), "? drift of the zero"},
        {"accelerometer.warmup_time", "s", 1, {300}, 1, 3600, AT(accelerometer.warmup_time), "? as proximity.warmup_time"},

        // Microphones. A level is a volume: largest minus smallest of 100 samples, counts.
        {"microphone.gain", "1", 3, {1.0}, 0.0, 10.0, FIRST(microphone.gain), "[M] spread +-8 % (e-puck2)"},
        {"microphone.x", "m", 3, {.015, .015, -.03}, -0.06, 0.06, FIRST(microphone.x), "? right front, left front, rear as described; no coordinates published; 3 cm from the axle's middle"},
        {"microphone.y", "m", 3, {-.026, .026, 0}, -0.06, 0.06, FIRST(microphone.y), "? as x"},
        {"microphone.direction", "rad", 3, {-1.0472, 1.0472, 3.14159}, -3.2, 3.2, FIRST(microphone.direction), "? outwards: -60 60 180 deg"},
        {"microphone.height", "m", 1, {0.03}, 0.0, 0.1, AT(microphone.height), "? as the loudspeakers'"},
        {"microphone.exponent", "1", 1, {1.0}, 0.0, 4.0, AT(microphone.exponent), "p of (0.1 m/d)^p: 1 in the open; [M] 1.16 in a room"},
        {"microphone.directivity", "1", 1, {0.0}, -1.0, 2.0, AT(microphone.directivity), "D of 1 + D cos(angle); [M] 0.3"},
        {"microphone.self_noise", "counts", 1, {0.0}, 0.0, 2000, AT(microphone.self_noise), "added to every level; [M] idle 8-10, which adc_noise of 2 counts makes by itself"},
        {"microphone.motor_noise", "counts", 1, {0.0}, 0.0, 2000, AT(microphone.motor_noise), "added at a mean of 1000 steps/s; [M] 9-15 with motors"},
        {"microphone.window_lost", "1", 1, {0.0}, 0.0, 0.99, AT(microphone.window_lost), "share of a microphone's samples that hold the one before"},
        {"microphone.warmup_gain", "1", 1, {0.0}, -0.9, 0.9, AT(microphone.warmup_gain), "[M] mean rose 290 to 316 in 60 s"},
        {"microphone.warmup_time", "s", 1, {300}, 1, 3600, AT(microphone.warmup_time), "as proximity's"},

        // Battery.
        {"battery.capacity", "W h", 1, {5.0}, 0.001, 50, AT(battery.capacity), "[W,S]"},
        {"battery.charge", "1", 1, {0.9}, 0.0, 1.0, AT(battery.charge), "state of charge at the start"},
        {"battery.resistance", "ohm", 1, {0.15}, 0.0, 2.0, AT(battery.resistance), "? cell and contacts"},
        {"battery.idle_power", "W", 1, {1.2}, 0.0, 10.0, AT(battery.idle_power), "5 W h last about 3 h"},
        {"battery.motor_power", "W", 1, {0.3}, 0.0, 5.0, AT(battery.motor_power), "? a motor while it steps"},
        {"battery.low_voltage", "V", 1, {3.4}, 2.5, 4.2, AT(battery.low_voltage), "[L] battery-low pin"},

        // Infra-red between range-and-bearing boards; index 0 is hardware number 1.
        {"ir.emitter_angle", "rad", 12, kBoardAngles, -3.2, 3.2, FIRST(ir.emitter_angle), "? beside the receivers: no drawing was at hand; [A] simulates sectors of 30 deg"},
        {"ir.emitter_gain", "1", 12, {1.0}, 0.0, 5.0, FIRST(ir.emitter_gain), "of one emitter"},
        {"ir.receiver_angle", "rad", 12, kBoardAngles, -3.2, 3.2, FIRST(ir.receiver_angle), "[R] 15 50 75 105 133 159 -165 -135 -105 -77 -50 -15 deg"},
        {"ir.receiver_gain", "1", 12, {1.0}, 0.0, 5.0, FIRST(ir.receiver_gain), "of one receiver's strength measurement"},
        {"ir.demodulator_gain", "1", 12, {1.0}, 0.0, 5.0, FIRST(ir.demodulator_gain), "of one receiver's demodulator"},
        {"ir.baseline", "counts", 12, {96, 103, 88, 110, 101, 92, 107, 99, 85, 104, 112, 94}, 0, 4095, FIRST(ir.baseline), "? strength reading in the dark; the board subtracts what it reads at boot"},
        {"ir.ring", "m", 1, {0.032}, 0.01, 0.06, AT(ir.ring), "? emitters and receivers 3 mm inside the rim"},
        {"ir.height", "m", 1, {0.052}, 0.0, 0.2, AT(ir.height), "[A] board above the floor; lower things do not shade"},
        {"ir.emitter_exponent", "1", 1, {1.0}, 0.0, 20.0, AT(ir.emitter_exponent), "? lobe cos^n, n = 1 a wide diode"},
        {"ir.power_reference", "1", 1, {115}, 0, 254, AT(ir.power_reference), "potentiometer byte at which the curve holds; [A] default, not recorded with the measurements"},
        {"ir.power_exponent", "1", 1, {1.0}, 0.1, 4.0, AT(ir.power_exponent), "? current (1 - byte/255)^n"},
        {"ir.power_floor", "1", 1, {0.0002}, 0.0, 1.0, AT(ir.power_floor), "[R] byte 255 reaches about 0: share of full current left there"},
        {"ir.distance", "m", 9, {.006, .026, .056, .106, .156, .306, .456, .606, .806}, 0.0, 5.0, FIRST(ir.distance), "[I] free path at which the levels hold, rising: 0 2 5 10 15 30 45 60 80 cm between bodies"},
        {"ir.level", "counts", 9, {9496, 4325, 2096, 1495, 1238, 1074, 941, 941, 941}, 0.0, 1e6, FIRST(ir.level), "[I] fitted: the range register of a board that receives all emitters of another then has the measured medians; 45, 60, 80 cm pooled, so that nothing rises"},
        {"ir.source_offset", "m", 1, {0.01}, 1e-4, 0.2, AT(ir.source_offset), "? d0 of the inverse square (d+d0)^-2"},
        {"ir.receiver_exponent", "1", 1, {0.5}, 0.0, 20.0, AT(ir.receiver_exponent), "[R] strength goes with sqrt(cos): what the board's range formula assumes"},
        {"ir.reach", "m", 1, {1.15}, 0.01, 20.0, AT(ir.reach), "free path at which all emitters at the reference power just trip a demodulator that faces them; [R] about 1 m, heard at 80 cm [I]"},
        {"ir.demodulator_exponent", "1", 1, {1.0}, 0.0, 20.0, AT(ir.demodulator_exponent), "? lobe cos^n"},
        {"ir.centre_frequency", "Hz", 1, {455e3}, 1e4, 1e6, AT(ir.centre_frequency), "[R] demodulators for 455 kHz"},
        {"ir.quality", "1", 1, {7.0}, 0.0, 100.0, AT(ir.quality), "? of the demodulator's band pass; the firmware's carrier is 6 % off: response 0.77"},
        {"ir.threshold", "1", 1, {1.0}, 0.01, 100.0, AT(ir.threshold), "of the demodulator, in units of the carrier at ir.reach"},
        {"ir.gain_share", "1", 1, {0.0}, 0.0, 1.0, AT(ir.gain_share), "? carriers weaker than this share of the strongest are not seen while it is on (gain control); 0: none"},
        {"ir.gain_hold", "s", 1, {300e-6}, 1e-6, 1.0, AT(ir.gain_hold), "? how long the strongest carrier holds the gain down after its end; less than two chips lets it come back within a frame"},
        {"ir.delay_on", "s", 1, {20e-6}, 1e-6, 1e-3, AT(ir.delay_on), "? 5-20 us; also what lets boards run ahead of each other"},
        {"ir.delay_off", "s", 1, {20e-6}, 1e-6, 1e-3, AT(ir.delay_off), "as delay_on; their difference distorts pulses and loses frames"},
        {"ir.min_burst", "s", 1, {10e-6}, 0.0, 1e-3, AT(ir.min_burst), "? shorter bursts are not seen; at most 0.9 delay_on"},
        {"ir.min_gap", "s", 1, {10e-6}, 0.0, 1e-3, AT(ir.min_gap), "? shorter gaps are not seen; at most 0.9 delay_off"},
        {"ir.level_delay", "s", 1, {20e-6}, 1e-6, 1e-3, AT(ir.level_delay), "? of the strength measurement"},
        {"ir.level_hold", "s", 1, {350e-6}, 0.0, 1e-2, AT(ir.level_hold), "? a level falls once it has been lower for so long; the board's detector holds the maximum anyway"},
        {"ir.ambient", "counts", 1, {30}, 0, 4095, AT(ir.ambient), "? added to the baseline at ambient level 1"},
        {"ir.emitter_spread", "1", 1, {0.10}, 0.0, 1.0, AT(ir.emitter_spread), "? log-normal, drawn once an emitter, .1-.3 a pair"},
        {"ir.receiver_spread", "1", 1, {0.06}, 0.0, 1.0, AT(ir.receiver_spread), "? log-normal, drawn once a receiver's strength"},
        {"ir.demodulator_spread", "1", 1, {0.10}, 0.0, 1.0, AT(ir.demodulator_spread), "? log-normal, drawn once a demodulator"},
        {"ir.frame_noise", "1", 1, {0.10}, 0.0, 1.0, AT(ir.frame_noise), "[I] log-normal, common to a frame's strengths at one board"},
        {"ir.receiver_noise", "1", 1, {0.05}, 0.0, 1.0, AT(ir.receiver_noise), "? log-normal, each frame and receiver"},
        {"ir.carrier_noise", "1", 1, {0.10}, 0.0, 1.0, AT(ir.carrier_noise), "? log-normal, each frame and demodulator: softens the edge of the reach"},
        {"ir.near_noise", "1", 1, {0.33}, 0.0, 2.0, AT(ir.near_noise), "[I] log-normal, added to frame_noise near contact"},
        {"ir.near_range", "m", 1, {0.06}, 1e-3, 1.0, AT(ir.near_range), "[I] over which near_noise fades"},
        {"ir.reflection", "1", 1, {0.0}, 0.0, 1.0, AT(ir.reflection), "? share of irradiance mirrored by a white wall or box (first order)"},
        {"ir.self_coupling", "1", 1, {0.0}, 0.0, 1e3, AT(ir.self_coupling), "? carrier of each own emitter at each own receiver, in thresholds; 0: a board hears itself by walls only"},
        {"ir.chip", "s", 1, {98.09e-6}, 1e-6, 1e-3, AT(ir.chip), "[R] half a bit: a frame has ended after 3 dark chips"},
        {"ir.rail", "counts", 1, {4095}, 1, 4095, AT(ir.rail), "highest count that a strength measurement reaches: the peak detector's rail"},
        {"ir.loss", "1", 1, {0.0}, 0.0, 1.0, AT(ir.loss), "share of frames that a board does not hear, whoever sends and however near; 0: losses emerge"},
        {"ir.spell", "1", 1, {0.0}, 0.0, 1.0, AT(ir.spell), "share of all time in which a board hears nothing of another, in spells beside those that beating crystals make"},
        {"ir.spell_time", "s", 1, {0.5}, 0.001, 1000, AT(ir.spell_time), "? time for which a spell is remembered; beats of 10-60 s [R]"},
        {"ir.stray", "1", 1, {0.0}, 0.0, 1.0, AT(ir.stray), "? share of frames that come by a reflection the world does not show: weaker, from elsewhere; .05-.2"},
        {"ir.stray_loss", "ln counts", 1, {0.7}, 0.0, 5.0, AT(ir.stray_loss), "? what such a reflection costs; 3-10 dB"},
        {"ir.refresh", "s", 1, {0.005}, 0.001, 1.0, AT(ir.refresh), "a burst that lasts longer is looked at anew when something moved"},

        // IRcom: the proximity sensors' light between robots, and between a robot and a TAM.
        {"ircom.power", "1", 1, {1.0}, 0.0, 10.0, AT(ircom.power), "of a robot's infra-red diodes, as others see them"},
        {"ircom.gain", "1", 1, {1.0}, 0.0, 10.0, AT(ircom.gain), "of a robot's phototransistors, for the light of others"},
        {"ircom.emitter_exponent", "1", 1, {2.0}, 0.0, 20.0, AT(ircom.emitter_exponent), "? lobe cos^n of a diode: half at 45 deg"},
        {"ircom.receiver_exponent", "1", 1, {1.0}, 0.0, 20.0, AT(ircom.receiver_exponent), "? lobe cos^n of a phototransistor"},
        {"ircom.reach", "m", 1, {0.4}, 0.01, 2.0, AT(ircom.reach), "beyond that nothing is seen: the measured curve gives a tenth of a count there"},
        {"ircom.delay", "s", 1, {20e-6}, 1e-6, 1e-3, AT(ircom.delay), "? every edge comes so much later, beside the parts' own time constants; also what lets boards run ahead of each other"},
        {"ircom.tam_power", "1", 1, {1.0}, 0.0, 10.0, AT(ircom.tam_power), "? of the TAM's diode; the same part as the robots', its current is 50 mA (39 ohm), theirs is not known"},
        {"ircom.tam_threshold", "counts", 1, {100}, 1, 4095, AT(ircom.tam_threshold), "? light at which the TAM's comparator switches (98.5 uA in 10 kohm), in counts of a robot's sensor: words cross everywhere in the booth"},
        {"ircom.tam_time", "s", 1, {20e-6}, 1e-6, 1e-3, AT(ircom.tam_time), "? time constant at the comparator's input; its filter alone has 1 us (10 kohm, 100 pF)"},

        // Contacts.
        {"contact.mu", "1", 1, {0.7}, 0.01, 3.0, AT(contact.mu), "[A] tyre along; 0.4-0.8 ?"},
        {"contact.mu_lateral", "1", 1, {0.7}, 0.01, 3.0, AT(contact.mu_lateral), "[A] tyre across"},
        {"contact.mu_skid", "1", 1, {0.2}, 0.0, 1.0, AT(contact.mu_skid), "? 0.1-0.3"},
        {"contact.mu_body", "1", 1, {0.3}, 0.0, 2.0, AT(contact.mu_body), "? robot body against things"},
        {"contact.mu_object", "1", 1, {0.5}, 0.0, 2.0, AT(contact.mu_object), "? movable things on the floor"},
        {"contact.creep", "m/(N s)", 1, {0.0}, 0.0, 1.0, AT(contact.creep), "? tyre creep speed a newton (force-dependent slip)"},
        {"contact.erp", "1", 1, {0.2}, 0.01, 1.0, AT(contact.erp), "[O] world error reduction"},
        {"contact.cfm", "1/N", 1, {1e-9}, 0.0, 1e-2, AT(contact.cfm), "[O] world constraint force mixing"},
        {"contact.soft_erp", "1", 1, {0.2}, 0.01, 1.0, AT(contact.soft_erp), "[O]"},
        {"contact.soft_cfm", "1/N", 1, {1e-5}, 0.0, 1.0, AT(contact.soft_cfm), "[O]"},
        {"contact.max_velocity", "m/s", 1, {0.5}, 0.01, 10.0, AT(contact.max_velocity), "[O] of correction"},
        {"contact.surface_layer", "m", 1, {1e-4}, 0.0, 1e-2, AT(contact.surface_layer), "[O]"},
        {"contact.push_height", "m", 1, {0.02}, 0.005, 0.05, AT(contact.push_height), "? where the body's widest ring touches"},

        // Cameras of the Linux board.
        {"camera.height", "m", 1, {0.122}, 0.05, 0.3, AT(camera.height), "[A] the mirror's focus, through which all rays of the omnidirectional camera go"},
        {"camera.eccentricity", "1", 1, {3.175}, 1.05, 20, AT(camera.eccentricity), "of the hyperbolic mirror; fitted to ARGoS' distance curve 1.25455 x 1.03848^px [A], see docs/fidelity.md"},
        {"camera.rim", "1", 1, {0.4861}, 0.1, 1.0, AT(camera.rim), "[A] the mirror's edge: radius 140 of 288 rows"},
        {"camera.rim_elevation", "rad", 1, {0.0873}, -0.5, 1.0, AT(camera.rim_elevation), "the omnidirectional turret of LIS sees up to 5 degrees above the horizon (e-puck.gctronic.com)"},
        {"camera.centre_x", "1", 1, {0.0208}, -0.3, 0.3, AT(camera.centre_x), "[A] the mirror's middle in the image, right of the image's: 182 of 352 columns"},
        {"camera.centre_y", "1", 1, {0.0}, -0.3, 0.3, AT(camera.centre_y), "[A] below the image's middle"},
        {"camera.front_x", "m", 1, {0.030}, 0.0, 0.06, AT(camera.front_x), "[W] the front camera, ahead of the axle"},
        {"camera.front_height", "m", 1, {0.028}, 0.005, 0.2, AT(camera.front_height), "[W] above the floor"},
        {"camera.front_fov", "rad", 1, {0.84}, 0.2, 2.4, AT(camera.front_fov), "[W] width of all 640 columns; 60 degrees [E]"},
        {"camera.exposure", "1", 1, {0.45}, 0.01, 5.0, AT(camera.exposure), "? level of a white floor in an ordinary room at the default gain, 1 = full scale"},
        {"camera.noise", "1", 1, {0.008}, 0.0, 0.2, AT(camera.noise), "? standard deviation of a pixel, of full scale, at the default gain"},
        {"camera.ring_level", "1", 1, {1.5}, 0.0, 50, AT(camera.ring_level), "? a lit LED of the ring, 1 = full scale"},
        {"camera.turret_level", "1", 1, {1.5}, 0.0, 50, AT(camera.turret_level), "? a lit LED of the RGB turret"},
        {"camera.booth_level", "1", 1, {8.0}, 0.0, 50, AT(camera.booth_level), "? a TAM's LED at full duty: at 25/255, which coordinators use, it still stands out"},
        {"camera.crosstalk", "1", 1, {0.06}, 0.0, 0.5, AT(camera.crosstalk), "? share of a colour's light that the pixels of the other two see"},
        {"camera.ring_radius", "m", 1, {0.004}, 0.0005, 0.02, AT(camera.ring_radius), "? of the spot as which a LED of the ring is seen"},
        {"camera.turret_radius", "m", 1, {0.0046}, 0.0005, 0.03, AT(camera.turret_radius), "of the spot as which a LED of the RGB turret is seen: between the blob areas of ARGoS, 95.644 exp(-0.11 d/cm) px, at 10 and at 20 cm [A]"},

        // The world.
        {"world.gravity", "m/s2", 1, {9.81}, 1.0, 30.0, AT(world.gravity), "standard"},
        {"world.slope_x", "rad", 1, {0.0}, -0.2, 0.2, AT(world.slope_x), "floor rises towards +x"},
        {"world.slope_y", "rad", 1, {0.0}, -0.2, 0.2, AT(world.slope_y), "floor rises towards +y"},
        {"world.publish_quantum", "counts", 1, {0.25}, 0.001, 16.0, AT(world.publish_quantum), "sensor values are rounded to this: below one step of the converter"},
    };
    // clang-format on
}

#undef AT
#undef FIRST

}  // namespace

std::span<const ParameterInfo> parameter_table() {
    static const std::vector<ParameterInfo> table = build_table();
    return table;
}

}  // namespace puckloop::physics
