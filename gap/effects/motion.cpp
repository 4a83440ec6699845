// Drives: wheels, steppers, commands, floor; at the end what the tracker does to them.

#include "gap/effects/effect.h"

namespace puckloop::gap {

using enum EffectRole;

// clang-format off
std::vector<Effect> motion_effects() {
    return {
        // Tyre wear, load and manufacture change the rolling radius of both wheels by the same share.
        // d = (1 + s) k steps
        {"wheel_scale", 1, "both wheels are larger or smaller than assumed",
         {{"wheel_scale", -0.08, 0.08, 0.02, "-3..+3 %; 41.0 against 41.35 mm is 0.85 %; -0.4 % on another robot"}},
         "robot.wheel_radius_left and _right together",
         "straight runs of two lengths, checked with a ruler (a wrong tracker scale looks the same)", {}, Mean, false, {}, nullptr, true},
        // Unequal rolling radii bend straight lines. curvature = 2 e / L, e = (rR - rL) / (rR + rL)
        {"wheel_mismatch", 2, "one wheel is larger than the other",
         {{"wheel_mismatch", -0.04, 0.04, 0.006, "0..1 %"}},
         "robot.wheel_radius_left and _right apart",
         "drive squares both clockwise and counter-clockwise, and a straight line forward and backward", {}, Mean, false, {}, nullptr, true},
        // The points of contact are not where the drawing has them. turn = turn_odometry L0 / L
        {"axle_length", 3, "the wheels stand further apart or closer than assumed",
         {{"robot.axle_length", 0.02, 1.0, 0.0015, "0..4 %; published models disagree by 4 %", {}, nullptr, 0.0,
           false, 2.0}},
         "robot.axle_length", "spot turns and circles of both senses", {}, Mean, false, {}, nullptr, true},
        // A tyre of finite width has a wandering point of contact: the tighter the turn, the longer the axle
        // acts. L_eff = L (1 + c |w| L/2 / (|v| + |w| L/2))
        {"turn_scrub", 4, "tyres scrub in tight turns",
         {{"robot.turn_scrub", -0.05, 3.0, 0.04, "0..4 % between circle and spot turn; measured 0.7 % on another robot"}},
         "robot.turn_scrub (physics/floor_motion)", "spot turns beside wide circles of the same angle", {}, Mean, false, {}, nullptr, true},
        // Friction limits acceleration: a jump of speed costs way at starts and gives some at stops.
        // lost = (change of speed)^2 / (2 mu g) at each jump
        {"acceleration_slip", 5, "wheels slip more or less than assumed when the speed jumps",
         {{"inverse_friction", 0.0, 60.0, 6.0, "mu 0.05..0.8: 17..1 mm for a jump to 12.9 cm/s; "
           "0: they follow at once, or speeds do not jump", {8.0, 25.0}}},
         "contact.mu and contact.mu_lateral", "the same distance in one hop and in ten", {}, Mean, false, {}, nullptr, true},
        // Rubber under a driving force rolls with a small steady slip that grows with load and slope.
        // v = (1 - c load - c2 incline) v_command
        {"load_creep", 6, "the tyres creep under load",
         {{"robot.load_creep", -0.1, 1.0, 0.1, "0..3 % of travel"},
          {"robot.slope_creep", -0.5, 1.0, 0.2, "?"}},
         "robot.load_creep with robot.load, robot.slope_creep with world.slope_x, world.slope_y (physics/floor_motion)",
         "the same runs with and without added mass, and on a slope", {"load_kg|incline_rad"}, Mean, false, {}, nullptr, true},
        // Above its pull-out speed a stepper skips whole groups of four steps; the counter does not know.
        // share lost = 1 / (1 + exp(-(|v| - v0) / w))
        {"step_loss", 7, "the motors lose steps above a speed",
         {{"robot.step_loss_speed", 200.0, 2000.0, 400.0, "v0 700..1000 steps/s", {750.0, 900.0, 1050.0}},
          {"robot.step_loss_width", 5.0, 200.0, 50.0, "w 30..100 steps/s"}},
         "robot.step_loss_speed, robot.step_loss_width",
         "straight runs at several speeds below and above the suspected threshold", {}, Mean, false, {}, nullptr, true},
        // Static friction or detent holds the wheel below a least speed. v = 0 for |v| < c0
        {"deadband", 9, "slow commands do not move the robot",
         {{"robot.deadband", 1.0, 500.0, 80.0, "near 0 for a good stepper, 20 % of the range for DC motors", {60.0}, nullptr, 0.0, true}},
         "robot.deadband (physics/wheel_drive)", "commands in small steps through zero", {}, Mean, false, {}, nullptr, true},
        // On reversal the motor turns some way before the wheel follows.
        // play operator of width b on each wheel
        {"backlash", 10, "the gears have play",
         {{"robot.backlash", 0.0, 0.3, 0.03, "0.5-2 degrees at the wheel: 0.2-0.7 mm", {0.01, 0.04}}},
         "robot.backlash", "reversals without a stop beside stops and starts in one direction", {}, Mean, false, {}, nullptr, true},
        // Radio, serial line and control loop delay a command. motion(t) = command(t - tau)
        {"command_latency", 11, "commands take effect late",
         {{"command.latency", 0.0, 0.6, 0.08, "20..150 ms and jitter; 0.11 rad a manoeuvre over Bluetooth", {0.05, 0.15}}},
         "the overlay's [uart] command_delay",
         "log the step counters beside the commands, or the time a command is sent and one it takes effect",
         {"cmd_left"}},
        // A frame on the way to the robot is dropped; the wheels go on as before.
        // with probability p a command does nothing, after one that did nothing with p + burst (1 - p)
        {"command_loss", 12, "commands get lost and the old one is kept",
         {{"command.loss", 0.0, 0.5, 0.05, "0..5 %", {0.01, 0.05}},
          {"command.loss_burst", 0.0, 1.0, 0.4, "bursts", {0.1}}},
         "the overlay's [uart] command_loss", "log sequence numbers at both ends", {"cmd_left"}, Scatter},
        // A tilted floor, a magnet or a cable pulls in a direction fixed in the room.
        // displacement = g t in a fixed direction while driving
        {"floor_tilt", 13, "something pulls the robot one way in the world",
         {{"robot.drift_x", -0.05, 0.05, 0.003, "?"},
          {"robot.drift_y", -0.05, 0.05, 0.003, "?"}},
         "robot.drift_x, robot.drift_y (physics/floor_motion)",
         "the same run with other headings at the start, and a minute's standing with the tracker on", {}, Mean,
         false, {},
         "a tracker whose place drifts slowly looks the same while the robot drives; let it stand for a minute with "
         "the tracker on: a floor moves no robot that stands, and a tracker that drifts goes on"},
        // Collisions and hands move the robot without its wheels. with rate q the pose jumps by about s
        {"collision_push", 14, "the robot is pushed now and then",
         {{"push.rate", 0.0, 1.0, 0.03, "rare", {0.02}},
          {"push.size", 0.001, 0.2, 0.03, "mm to cm", {0.004, 0.02}},
          {"push.turn", 0.0, 3.0, 0.3, "none to a turn", {0.0, 0.05}}},
         "push.rate, push.size, push.turn (physics/floor_motion); other robots and things push as well",
         "film the arena; a run with nobody near", {}, Outlier},
        // The tracker follows a point beside the middle of the axle, or a marker turned against the body.
        // seen = p + R(theta) (dx, dy), theta + d
        {"marker_offset", 15, "the marker is not on the axle",
         {{"tracker.marker_x", -0.06, 0.06, 0.004, "1..5 mm"},
          {"tracker.marker_y", -0.06, 0.06, 0.004, "1..5 mm"},
          {"tracker.marker_angle", -0.4, 0.4, 0.05, "0..5 degrees"}},
         "measuring chain", "a spot turn: the centre then draws a circle", {}, Mean, true},
        // Exposure, processing and transport delay the pose. pose(t) belongs to t - tau
        {"tracker_delay", 16, "the tracker is late",
         {{"tracker.delay", 0.0, 0.8, 0.06, "1..3 frames, 50..100 ms", {0.04, 0.12}}},
         "measuring chain",
         "log the step counters with the robot's clock, or flash an LED that the tracker sees", {}, Mean,
         true},
        // Gyro bias or a warming tracker turns the heading even at rest. d theta / dt = r
        {"heading_drift", 17, "the heading drifts with time",
         {{"tracker.heading_drift", -0.2, 0.2, 0.005, "?"}},
         "measuring chain", "let the robot stand for a minute with the tracker on"},
    };
}
// clang-format on

}  // namespace puckloop::gap
