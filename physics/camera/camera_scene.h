#pragma once
// What cameras see, at one instant: kept up to date by the signals of the world's camera port.

#include "physics/camera/camera_signals.h"
#include "physics/description/parameters.h"
#include "physics/description/plan.h"

#include <array>
#include <vector>

namespace puckloop::physics {

/// A ball of one colour, as bright from every side; 1 is the sensor's full scale at the default gain.
struct Glow {
    double x = 0.0, y = 0.0, z = 0.0;
    double radius = 0.0;
    std::array<double, 3> level{};
};

/// Something that stands upright and hides what is behind it.
struct Body {
    Shape shape;
    std::array<double, 3> side{}, top{};  ///< share of the light that comes back, red, green, blue
    int robot = -1;                       ///< whose body it is
};

/// A piece of floor of another grey.
struct FloorPatch {
    bool disc = false;
    double x = 0.0, y = 0.0, cosine = 1.0, sine = 0.0;
    double half_length = 0.0, half_width = 0.0;  ///< or radius
    double reach = 0.0;                          ///< of a circle around it
    double grey = 0.0;
    FloorImage image{};  ///< in place of that; empty: none
};

class CameraScene {
  public:
    /// As described; nothing shines yet.
    explicit CameraScene(const World& world);

    void change(std::size_t id, double value);

    struct Pose {
        double x = 0.0, y = 0.0, heading = 0.0;
    };
    const Pose& robot(std::size_t index) const { return poses_[index]; }
    const Parameters& parameters(std::size_t robot) const { return robots_[robot]; }
    double ambient() const { return ambient_; }

    /// Everything that stands there and everything that shines, but for what robot `but` carries.
    void bodies(std::size_t but, std::vector<Body>& out) const;
    void glows(std::size_t but, std::vector<Glow>& out) const;
    /// Later ones lie on earlier ones.
    const std::vector<FloorPatch>& patches() const { return seen_patches_; }
    double floor_grey() const { return floor_grey_; }

  private:
    struct Moving {
        Shape shape;  // at the origin
        bool out = false;
    };
    void change_patch(std::size_t index, std::size_t part, double value);
    void move_lamp(std::size_t index, std::size_t part, double value);
    void turret_glows(std::size_t robot, std::vector<Glow>& out) const;
    void ring_glows(std::size_t robot, std::vector<Glow>& out) const;

    CameraSignals signals_;
    double ambient_, floor_grey_;
    std::vector<Parameters> robots_;  // of each robot
    std::vector<Pose> poses_;         // of everything that moves, robots first
    std::vector<Moving> moving_;
    std::vector<ShapeValues> fixed_, added_;
    std::vector<std::array<double, kCameraPatchValues>> patches_;
    std::vector<FloorPatch> seen_patches_;
    std::vector<std::array<double, kRingLeds>> ring_;
    std::vector<std::array<double, kTurretColours>> turret_;
    std::vector<FloorImage> images_;
    std::vector<Glow> lamps_;
    std::vector<Glow> booth_lights_;  // levels: share of full duty
};

/// The images on the floor of a world as described; a patch is signalled with its image's number there.
std::vector<FloorImage> floor_images(const World& world);
/// A patch as signals.
std::array<double, kCameraPatchValues> values_of(const Patch& patch, const std::vector<FloorImage>& images);

}  // namespace puckloop::physics
