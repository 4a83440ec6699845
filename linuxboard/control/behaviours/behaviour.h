#pragma once
// What a user writes: from the sensors of this step to the actuators of this step.
//
//     class Spin : public puckloop::control::Behaviour {
//         Actuators step(const Sensors&, double) override { return {.left_mm_s = 50, .right_mm_s = -50}; }
//     };

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace puckloop::control {

/// Another robot heard by the range-and-bearing board within the last second.
struct Neighbour {
    int id = 0;              ///< 1..255
    std::uint32_t data = 0;  ///< what it sends: Actuators::say of its behaviour
    double bearing = 0;      ///< rad, -pi..pi, counter-clockwise from straight ahead
    double range_cm = 0;     ///< between the surfaces; scatters, and shows little beyond 30 cm
    double age = 0;          ///< s since its last packet
};

/// A coloured light that the omnidirectional camera sees.
struct ColouredSpot {
    enum class Colour : std::uint8_t { Red, Green, Blue };
    Colour colour = Colour::Red;
    double bearing = 0;      ///< rad, as of a neighbour
    double distance_cm = 0;  ///< from the robot's middle
    int area = 0;            ///< pixels
};

/// A word that came by the proximity sensors' light (IRcom): from another robot or from a TAM.
struct InfraredWord {
    std::uint8_t data = 0;
    double bearing = 0;   ///< rad, -pi..pi, of the sensor that saw it brightest
    double range_cm = 0;  ///< between the middles of two robots face to face; of a TAM it shows little
};

/// Rings of 8 are in the robot's order: 0 is front right, then clockwise; kRingBearing gives where they look.
struct Sensors {
    std::array<double, 8> proximity{};  ///< ADC counts reflected, >= 0; 0 nothing, about 4000 contact
    std::array<double, 8> light{};      ///< brightness, 0 dark to 4095
    std::optional<std::array<double, 3>> ground;  ///< left, centre, right; 0 black to 1000 white
    bool battery_ok = true;
    std::vector<Neighbour> neighbours;                 ///< by id; empty without a range-and-bearing board
    std::optional<std::vector<ColouredSpot>> spots{};  ///< largest first; none without a camera
    std::optional<InfraredWord> word{};                ///< since the step before
};

struct Actuators {
    double left_mm_s = 0;  ///< wheel speed, clamped to +-kMaximumSpeed
    double right_mm_s = 0;
    std::uint8_t ring_leds = 0;  ///< bit i = LED i: 0 front, then clockwise every 45 degrees
    bool front_led = false;
    bool body_led = false;
    std::optional<std::uint8_t> word{};  ///< to be sent by IRcom in this step
    std::uint32_t say = 0;  ///< to the neighbours; 0, 8, 16 or 24 bits of it go out with 1 to 4 payload bytes
};

inline constexpr double kMillimetresPerStep =
    41.0 * 3.14159265358979 / 1000.0;                                ///< 41 mm wheel, 1000 steps a turn
inline constexpr double kMaximumSpeed = 1000 * kMillimetresPerStep;  ///< 1000 steps/s
/// Bearings of proximity and light sensors, radians, counter-clockwise from straight ahead.
inline constexpr std::array<double, 8> kRingBearing{-0.297, -0.873, -1.571, -2.618,
                                                    2.618,  1.571,  0.873,  0.297};

class Behaviour {
  public:
    virtual ~Behaviour() = default;
    /// Called every 100 ms with the newest sensors; `t` is the time since the start in seconds.
    virtual Actuators step(const Sensors& sensors, double t) = 0;
    /// As of the last step: a word of LoopSettings may be sent.
    virtual bool may_send() const { return true; }
};

/// "wander", "light", "aggregate", "follow", "seek", "serve", "still" or "spin"; null for any other name.
/// `own_id` is the robot's among its neighbours.
std::unique_ptr<Behaviour> make_behaviour(std::string_view name, int own_id = 0);
/// True for the behaviours that make no sense without a range-and-bearing board.
bool needs_neighbours(std::string_view name);
/// True for the behaviours that make no sense without a camera.
bool needs_camera(std::string_view name);

}  // namespace puckloop::control
