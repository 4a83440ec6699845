#pragma once
// What stands in the world, as plain data: filled by a scenario, checked by check(), carried between
// processes as JSON text. Metres, radians, kilograms; x forward (east), y left (north), heading from +x
// counter-clockwise; the floor is z = 0.

#include "physics/description/extension.h"
#include "physics/description/things.h"
#include "physics/description/virtual_things.h"

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

struct Arena {
    std::vector<Point> corners;  ///< polygon, either sense; three or more, no edge crossing another
    bool walls = true;           ///< a wall along every edge, its inner face on the edge
    double wall_height = 0.10;
    double wall_thickness = 0.02;
    double reflectivity = 1.0;
    double floor_grey = 1.0;  ///< 0 black .. 1 white
    Place place{};
};
/// Axis-aligned, centred on the origin.
Arena rectangular_arena(double width, double depth);

/// A TAM: a booth that a robot drives into (physics/description/booth.h).
struct Booth {
    std::string name;
    double x = 0.0, y = 0.0;  ///< of its middle
    double heading = 0.0;     ///< the way its opening looks
    double reflectivity = 1.0;
    /// Signal ids on the link to its board ("barrier_front", "barrier_back", "led_top_red", ...). Names that
    /// are absent are neither read nor published.
    std::map<std::string, std::uint16_t> signals{};
    Place place{};
};

struct Robot {
    std::string name;
    double x = 0.0, y = 0.0, heading = 0.0;
    std::map<std::string, double> parameters;  ///< over the world's, e.g. "robot.axle_length"
    /// Signal ids on the links to the board ("wheel_left", "proximity0", "ambient0", "acc_x", "battery_v",
    /// "mic_level0") and to the ground sensor ("ground0".."ground2", "ground_ambient0".."2"). Names that are
    /// absent are neither read nor published.
    std::map<std::string, std::uint16_t> board_signals;
    std::map<std::string, std::uint16_t> ground_signals;
    bool rab = false;     ///< carries a range-and-bearing board
    bool camera = false;  ///< its Linux board has cameras
    /// Signal ids on the link between that board and the infra-red medium: "emitter1".., "carrier", "power",
    /// "demod1".., "peak1"..
    std::map<std::string, std::uint16_t> rab_signals{};
    Place place{};
};

struct Recording {
    std::string directory;  ///< trajectory.csv, sensors.csv, objects.csv go here; empty = nothing is recorded
    double period = 0.1;    ///< s, a multiple of 1 ms
    std::string log{};      ///< file for the world's log; empty: none
};

struct World {
    std::string node_name = "world";
    std::string file;  ///< the user's file, for error messages
    std::uint64_t seed = 1;
    double ambient_light = 1.0;  ///< 0 dark, 1 ordinary room, 12 the brightest the sensors distinguish
    Arena arena;
    std::vector<Wall> walls;
    std::vector<Box> boxes;
    std::vector<Cylinder> cylinders;
    std::vector<Lamp> lamps;
    std::vector<Speaker> speakers;
    std::vector<Patch> patches;
    VirtualThings virtuals{};
    std::vector<Robot> robots;
    std::vector<Booth> booths{};
    std::map<std::string, double> parameters;  ///< for all robots and the world
    std::vector<ExtensionTerm> extension{};    ///< for all robots
    bool ircom = false;                        ///< robots' and TAMs' infra-red light reaches others
    Recording recording;
};

/// The lamps of the world, then the virtual ones that this robot senses.
std::vector<Lamp> lamps_sensed_by(const World& world, std::string_view robot);

/// Throws InputError naming the element and its place: sizes, names, overlaps, what is outside the arena,
/// unknown parameters, values out of range.
void check(const World& world);
/// The same of a world whose virtual things are sensed by robots of another one.
void check_things(const World& world);
/// Throws InputError, with `file`, for virtual things that name robots which are none of these.
void check_who_senses(const VirtualThings& things, const std::vector<Robot>& robots, const std::string& file);

/// One JSON object; from_json throws InputError on anything that to_json would not have written.
std::string to_json(const World& world);
World from_json(std::string_view text);

}  // namespace puckloop::physics
