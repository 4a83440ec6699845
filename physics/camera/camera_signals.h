#pragma once
// The signals between the world's port "<robot>.camera" and the robot's Linux board: what cameras see, as of
// the last step before each of their frames. Both ends compute the ids from the same description.

#include "cosim/core/time.h"
#include "physics/description/description.h"
#include "physics/world/pose_signals.h"

#include <cstddef>
#include <cstdint>

namespace puckloop::physics {

/// Camera frames begin at whole multiples of 1/30 s, or of a multiple of that.
inline constexpr cosim::Time kCameraRate = 30;  ///< Hz

inline constexpr std::size_t kRingLeds = 10;      ///< led0..7, led_front, led_body
inline constexpr std::size_t kTurretColours = 9;  ///< rgb0_red .. rgb2_blue
inline constexpr std::size_t kCameraPatchValues =
    8;  ///< disc, x, y, heading, length or radius, width, grey (or -1 - number of an image), there

/// Ids of the port's signals.
class CameraSignals {
  public:
    explicit CameraSignals(const World& world);

    static constexpr std::size_t kAmbient = 0;
    static constexpr std::size_t kFloorGrey = 1;
    std::size_t pose(std::size_t moving) const { return 2 + kPoseSignals * moving; }
    std::size_t out(std::size_t moving) const { return outs_ + moving; }
    std::size_t ring_led(std::size_t robot, std::size_t led) const { return ring_ + robot * kRingLeds + led; }
    std::size_t turret(std::size_t robot, std::size_t colour) const {
        return turret_ + robot * kTurretColours + colour;
    }
    /// Intensity of a lamp that was there from the start.
    std::size_t lamp(std::size_t lamp) const { return lamps_ + lamp; }
    /// The first of kLampValues of the lamp that is number `lamp` now, from the upper end of all ids down;
    /// the intensity counts for lamps that were added.
    static constexpr std::size_t kLampValues = 4;  ///< x, y, height, intensity
    static constexpr std::size_t kMostLamps = 512;
    static constexpr std::size_t kFirstLampPlace = 0x10000 - kMostLamps * kLampValues;
    static std::size_t lamp_place(std::size_t lamp) {
        return kFirstLampPlace + (kMostLamps - 1 - lamp) * kLampValues;
    }
    /// Red, green or blue (0..2) of light number `light` of all booths, kLights each
    /// (physics/description/booth.h).
    std::size_t booth_light(std::size_t light, std::size_t colour) const {
        return lights_ + 3 * light + colour;
    }
    /// The first of kShapeSignals of a fixed thing, or of a movable one that was added.
    std::size_t shape(bool fixed, std::size_t index) const {
        return open_ + (3 * index + (fixed ? 0 : 1)) * kShapeSignals;
    }
    /// The first of kCameraPatchValues of a floor patch.
    std::size_t patch(std::size_t index) const { return open_ + (3 * index + 2) * kShapeSignals; }

    std::size_t robots() const { return robots_; }
    std::size_t moving() const { return moving_; }
    std::size_t lamp_count() const { return lights_ - lamps_; }
    std::size_t booth_lights() const { return (open_ - lights_) / 3; }

    /// What the signal `id` is of, for whoever receives it.
    enum class Kind : std::uint8_t {
        Ambient,
        FloorGrey,
        Pose,
        Out,
        RingLed,
        Turret,
        Lamp,
        LampPlace,
        BoothLight,
        Fixed,
        Added,
        Patch
    };
    struct Meaning {
        Kind kind = Kind::Ambient;
        std::size_t index = 0;  ///< robot, moving thing, lamp, light, shape or patch
        std::size_t part = 0;   ///< which of its values
    };
    Meaning meaning(std::size_t id) const;

  private:
    std::size_t robots_, moving_;
    std::size_t outs_, ring_, turret_, lamps_, lights_, open_;
};
static_assert(kCameraPatchValues == kShapeSignals);

/// Frame time `frame` (kCameraRate a second).
inline cosim::Time camera_frame_time(std::int64_t frame) {
    return frame / kCameraRate * cosim::kSecond + frame % kCameraRate * cosim::kSecond / kCameraRate;
}
/// The first message time (a whole millisecond) at or after `time` at which the world publishes: the last
/// one not after a frame.
cosim::Time next_camera_message(cosim::Time time);

/// The world publishes for cameras when any robot has one.
inline bool has_camera(const World& world) {
    return std::any_of(world.robots.begin(), world.robots.end(), [](const Robot& r) { return r.camera; });
}

}  // namespace puckloop::physics
