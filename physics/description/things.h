#pragma once
// The things of a world, as plain data. Metres, radians, kilograms, as in physics/description/description.h.

#include "physics/description/floor_image.h"

#include <cstdint>
#include <string>

namespace puckloop::physics {

struct Point {
    double x = 0.0;
    double y = 0.0;
    friend bool operator==(const Point&, const Point&) = default;
};

/// Where in the user's file a thing was described ("line 12"), for error messages; may be empty.
using Place = std::string;

struct Wall {
    std::string name;
    Point from, to;  ///< ends of the centre line
    double thickness = 0.01;
    double height = 0.10;
    double reflectivity = 1.0;  ///< infra-red: 0.05 black .. 1 white .. 1.5 foil
    Place place{};
};

struct Box {
    std::string name;
    double x = 0.0, y = 0.0, heading = 0.0;
    double length = 0.1, width = 0.1, height = 0.1;  ///< along the box's own x, y, z
    bool movable = false;
    double mass = 0.1;  ///< used when movable
    double reflectivity = 1.0;
    Place place{};
};

struct Cylinder {
    std::string name;
    double x = 0.0, y = 0.0;
    double radius = 0.05, height = 0.1;
    bool movable = false;
    double mass = 0.1;
    double reflectivity = 1.0;
    Place place{};
};

struct Lamp {
    std::string name;
    double x = 0.0, y = 0.0;
    double height = 0.05;    ///< of the bulb
    double intensity = 1.0;  ///< share of full light at the bulb
    Place place{};
};

/// A loudspeaker: steady noise, or a wave (physics/sensors/speaker_wave.h).
struct Speaker {
    std::string name;
    double x = 0.0, y = 0.0;
    double height = 0.03;
    double level = 0.0;       ///< counts (volume) at a plain microphone 0.1 m away, on its axis
    double on = 0.0;          ///< s: when it begins
    double off = 1e9;         ///< s: when it ends
    double every = 0.0;       ///< s: from one sound's begin to the next's; 0: there is one
    std::uint64_t times = 0;  ///< sounds in all, if there are several; 0: without end
    bool wave = false;        ///< noise that travels
    double tone = 0.0;        ///< Hz; 0: noise
    double sweep_to = 0.0;    ///< Hz: what the tone becomes, evenly, up to its end; 0: it stays
    Place place{};
};

/// A piece of floor of another grey; later patches lie on top of earlier ones.
struct Patch {
    std::string name;
    enum class Shape : std::uint8_t { Rectangle, Disc };
    Shape shape = Shape::Rectangle;
    double x = 0.0, y = 0.0, heading = 0.0;
    double length = 0.1, width = 0.1;  ///< rectangle
    double radius = 0.05;              ///< disc
    double grey = 0.0;
    FloorImage image{};  ///< of a rectangle, in place of its grey; empty: none
    Place place{};
};

}  // namespace puckloop::physics
