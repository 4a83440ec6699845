#pragma once
// Things that are not there: robots sense them, and nothing else in the world meets them. As plain data.

#include "physics/description/things.h"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

/// Is the robot one of them? Empty: all are.
inline bool includes_robot(const std::vector<std::string>& robots, std::string_view robot) {
    return robots.empty() || std::find(robots.begin(), robots.end(), robot) != robots.end();
}

/// A thing that only the sensors of robots meet: walls, boxes and cylinders are in the way of proximity
/// sensors' light, lamps shine on light sensors. Nothing bumps into it, no camera sees it, and it hides
/// nothing from anything else.
template <class Thing>
struct Virtual : Thing {
    std::vector<std::string> robots{};  ///< who senses it; empty: all

    bool sensed_by(std::string_view robot) const { return includes_robot(robots, robot); }
};

/// A trail on the floor that robots lay and their ground sensors see: where there is much of it the floor is
/// of another grey. It evaporates and spreads; it is nowhere stronger than full.
struct Pheromone {
    std::string name;
    std::vector<std::string> robots{};  ///< who lays it; empty: all
    std::string led{};          ///< laid while this LED of the robot is lit ("led_body"); empty: always
    double radius = 0.02;       ///< m: evenly in this disc about the axle's middle
    double fill_time = 0.1;     ///< s under such a disc until the floor is full; above 0
    double half_life = 30.0;    ///< s until half of it is gone; 0: it stays
    double diffusion = 0.0;     ///< m2/s
    double grey = 0.0;          ///< the floor's, where it is full
    double cell = 0.01;         ///< m: side of the squares that it is computed in
    double record_every = 0.0;  ///< s: rows of pheromones.csv; 0: at the end alone
    Place place{};
};

/// A range-and-bearing board without a robot: it sends, and does not listen.
struct VirtualBoard {
    std::string name;
    double x = 0.0, y = 0.0, heading = 0.0;
    std::vector<std::uint8_t> data{};  ///< 1 to 4 bytes of payload, the highest first
    double power = 115.0;              ///< potentiometer byte, 0 (furthest) .. 255
    double begin = 0.0;                ///< s: first frame
    double every = 0.1;                ///< s: from one to the next
    double jitter = 0.002;             ///< s: standard deviation of a frame's begin
    Place place{};
};

/// check() refuses more.
inline constexpr std::size_t kMostVirtualBoards = 64;

struct VirtualThings {
    std::vector<Virtual<Wall>> walls{};
    std::vector<Virtual<Box>> boxes{};
    std::vector<Virtual<Cylinder>> cylinders{};
    std::vector<Virtual<Lamp>> lamps{};
    std::vector<Pheromone> pheromones{};
    std::vector<VirtualBoard> boards{};
};

}  // namespace puckloop::physics
