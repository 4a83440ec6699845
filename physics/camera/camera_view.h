#pragma once
// The picture that a robot's camera takes of a scene.
//
// Rays go into columns: all pixels that look the same way seen from above meet the same bodies, which are
// upright, so a column knows each of them as a stretch of distance and a height. LEDs and lamps are balls
// drawn over that where nothing nearer hides them.
//
// Deviations: 1. Light is linear in the image (no gamma); exposure is fixed. 2. All surfaces are matt, lit
// alike from everywhere: no shadows, no lamp lights a floor, no LED lights what is near it. 3. The lens is
// sharp; LEDs do not bleed. 4. The robot does not tilt. 5. The robot's own body below the mirror is a disc
// of its radius at its height.

#include "base/random.h"
#include "physics/camera/camera_scene.h"
#include "physics/camera/optics.h"

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace puckloop::physics {

/// How the camera is set.
struct Exposure {
    int gain = 26;         ///< 16 more is twice as bright
    int brightness = 0;    ///< % of full scale, added
    int contrast = 100;    ///< %
    int saturation = 100;  ///< %
    bool mirror = false, flip = false;
};

class CameraView {
  public:
    /// Of the description's robot number `robot`; `seed` is the run's.
    CameraView(CameraKind kind, const CameraScene& scene, std::size_t robot, const std::string& robot_name,
               std::uint64_t seed);

    /// Red, green, blue of each pixel, rows from the top. `frame`: its number, for the noise.
    void render(ImageSize size, const Exposure& exposure, std::uint64_t frame, std::span<std::uint8_t> rgb);

  private:
    using Colour = std::array<float, 3>;

    /// What a column meets, nearest first.
    struct Span {
        float in = 0, out = 0, height = 0;
        Colour side{}, top{};
    };
    struct Mode {
        Optics optics;
        PixelMap map;
    };
    Mode& mode(ImageSize size);
    void meet_bodies(const Mode& mode);
    void draw_pixels(const Mode& mode);
    void draw_glow(const Mode& mode, const Glow& glow);
    float hidden_from(const std::vector<Span>& column, float slope) const;
    Colour floor_at(double x, double y) const;
    void expose(ImageSize size, const Exposure& exposure, std::uint64_t frame,
                std::span<std::uint8_t> rgb) const;

    CameraKind kind_;
    const CameraScene& scene_;
    std::size_t robot_;
    CameraParameters parameters_;
    BodyParameters body_;
    std::uint64_t noise_seed_;
    std::map<std::uint32_t, std::unique_ptr<Mode>> modes_;  // by height: no two sizes share one

    // Of the picture being made.
    double x_ = 0, y_ = 0, cosine_ = 1, sine_ = 0;  // the camera's point and the robot's heading
    std::vector<Body> bodies_;
    std::vector<Glow> glows_;
    std::vector<std::vector<Span>> columns_;
    std::vector<Colour> light_;
};

}  // namespace puckloop::physics
