#pragma once
// A TAM in the world: its walls, the two light barriers that bodies interrupt, its coloured LEDs.
//
// The booth's own frame: origin on the floor in the middle of its 12 x 12 cm, x out of the opening, y to the
// left of that, z up.
//
// Source: the IRIDIA TAM's plans (version 5: side shell, diffuser, side bumper; millimetres), and for the
// places of barriers and LEDs the TAM's model in ARGoS by the same laboratory.
//
// Deviations:
// 1. The top shell, screws and the gap of 1.7 mm above the bumpers' boards are left out.
// 2. A beam is a strip between the shells; what a body interrupts is its shadow across the strip, seen from
//    above. Bodies reach down to the beam, 5 mm above the floor: an e-puck's wheels and battery do.
// 3. Each LED behind the diffuser is a spot of one centimetre's radius, as bright everywhere.

#include "physics/description/description.h"
#include "physics/description/plan.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

namespace booth {

inline constexpr double kSize = 0.120;           ///< m: length, width and height
inline constexpr double kShell = 0.0103;         ///< thickness of a side
inline constexpr double kBumper = 0.0046;        ///< a strip inside each side ...
inline constexpr double kBumperHeight = 0.016;   ///< ... near the floor ...
inline constexpr double kBumperLength = 0.1083;  ///< ... from the opening on
inline constexpr double kBack = -0.0359;         ///< x of the diffuser's face: behind it are the boards
inline constexpr std::size_t kParts = 5;         ///< shapes that stand on the floor
inline constexpr std::size_t kBarriers = 2;      ///< front first
inline constexpr std::array<double, kBarriers> kBeam{0.052, 0.012};  ///< x of the beams' middles
inline constexpr double kBeamHeight = 0.005;
inline constexpr double kBeamWidth = 0.002;  ///< of the phototransistor's opening; an assumption

/// Where a light is, in the booth's frame, and how wide it is seen.
struct LampPlace {
    const char* name;  ///< "left", ...: the board's names
    double x, y, z, radius;
};
inline constexpr std::size_t kLights = 4;
inline constexpr std::array<LampPlace, kLights> kLight{{{"right", -0.035, -0.025, 0.060, 0.010},
                                                        {"middle", -0.035, 0.0, 0.060, 0.010},
                                                        {"left", -0.035, 0.025, 0.060, 0.010},
                                                        {"top", -0.050, 0.0, 0.113, 0.0025}}};
/// The infra-red transceiver is on the left side board and looks across (the boards' drawings: 21 mm from the
/// main board's edge, where the beams are at 63 and 103 mm, and 30 mm up).
inline constexpr std::array<double, 3> kTransceiver{-0.030, 0.049, 0.030};
inline constexpr std::array<double, 2> kTransceiverLooks{0.0, -1.0};

}  // namespace booth

/// A light that cameras see: a ball of one colour, as bright from every side.
struct ColouredLight {
    double x = 0.0, y = 0.0, z = 0.0;           ///< m, of its middle, in the world's frame
    double radius = 0.0;                        ///< m
    double red = 0.0, green = 0.0, blue = 0.0;  ///< share of the LED's full brightness, 0..1; all 0: off
    bool lit() const { return red > 0.0 || green > 0.0 || blue > 0.0; }
    friend bool operator==(const ColouredLight&, const ColouredLight&) = default;
};

bool is_booth(const World& world, std::string_view name);

/// A point of the booth's frame in the world's.
Point from_booth(const Booth& booth, double x, double y);
/// Its kParts parts, and what each is called ("tam0 left side").
std::vector<Shape> shapes_of(const Booth& booth);
std::vector<std::string> part_names(const Booth& booth);

/// What of a booth changes with time.
class BoothModel {
  public:
    explicit BoothModel(const Booth& booth);

    /// A body might reach the beams: all others need not be looked at.
    bool near(const Shape& body) const;
    /// Share of each beam's width that bodies interrupt, 0..1, front first; those that are near() count.
    std::array<double, booth::kBarriers> interrupted(std::span<const Shape* const> bodies) const;

    /// Red, green or blue (0..2) of light `index` shines for `duty` of the time, 0..1.
    void shine(std::size_t index, std::size_t colour, double duty);
    /// Everything goes dark.
    void dark();
    /// In the order of booth::kLight.
    std::span<const ColouredLight> lights() const { return lights_; }

    /// As of the last step.
    std::array<double, booth::kBarriers> barriers{};

  private:
    Booth booth_;
    double cosine_, sine_;
    std::array<ColouredLight, booth::kLights> lights_;
};

}  // namespace puckloop::physics
