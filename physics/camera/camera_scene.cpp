#include "physics/camera/camera_scene.h"

#include "physics/description/booth.h"
#include "physics/description/robot_parameters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

// Places of the e-puck's LEDs, CAD of the robot (m): the ring of eight, LED 0 in front, then clockwise, in
// the light-coloured ring around the body, whose edge is all that others see; the three of the RGB turret.
constexpr double kRingHeight = 0.040;
constexpr double kRingOut = 0.001;  // beyond the body
constexpr std::size_t kRing = 8;
constexpr std::size_t kFrontLed = 8, kBodyLed = 9;
constexpr double kFrontHeight = 0.030;
constexpr double kTurretHeight = 0.0755;
constexpr std::array<std::array<double, 2>, 3> kTurretPlace{
    {{0.013, -0.021}, {0.013, 0.021}, {-0.0325, -0.003}}};
constexpr double kLampRadius = 0.02;
constexpr double kLampLevel = 20.0;

/// Visible grey of walls and things: infra-red reflectivity gives no more than dark or light.
constexpr double kBrightestGrey = 0.85;
constexpr double kTopShare = 1.0;
constexpr std::array<double, 3> kRobotSide{0.22, 0.24, 0.22};  // translucent body, dark boards behind
constexpr std::array<double, 3> kRobotTop{0.08, 0.16, 0.08};   // printed circuit

std::array<double, 3> grey_of(double reflectivity) {
    const double share = kBrightestGrey * std::min(reflectivity, 1.0);
    return {share, share, share};
}

Body plain(const Shape& shape) {
    Body body{shape, grey_of(shape.reflectivity), grey_of(shape.reflectivity)};
    for (double& share : body.top)
        share *= kTopShare;
    return body;
}

template <typename List>
auto& grown(List& list, std::size_t index) {
    if (index >= list.size()) list.resize(index + 1);
    return list[index];
}

FloorPatch patch_from(const std::array<double, kCameraPatchValues>& v,
                      const std::vector<FloorImage>& images) {
    FloorPatch patch;
    patch.disc = v[0] != 0.0;
    patch.x = v[1];
    patch.y = v[2];
    patch.cosine = std::cos(v[3]);
    patch.sine = std::sin(v[3]);
    patch.half_length = patch.disc ? v[4] : v[4] / 2;
    patch.half_width = patch.disc ? v[4] : v[5] / 2;
    patch.reach = patch.disc ? v[4] : std::hypot(patch.half_length, patch.half_width);
    patch.grey = v[6];
    if (const auto image = static_cast<std::size_t>(-1.0 - std::min(v[6], -1.0));
        v[6] < 0.0 && image < images.size())
        patch.image = images[image];
    return patch;
}

}  // namespace

std::vector<FloorImage> floor_images(const World& world) {
    std::vector<FloorImage> images;
    for (const Patch& patch : world.patches)
        if (!patch.image.empty()) images.push_back(patch.image);
    return images;
}

std::array<double, kCameraPatchValues> values_of(const Patch& patch, const std::vector<FloorImage>& images) {
    const bool disc = patch.shape == Patch::Shape::Disc;
    double colour = patch.grey;
    if (!patch.image.empty())
        colour =
            -1.0 - static_cast<double>(std::find(images.begin(), images.end(), patch.image) - images.begin());
    return {disc ? 1.0 : 0.0, patch.x, patch.y, patch.heading, disc ? patch.radius : patch.length,
            patch.width,      colour,  1.0};
}

CameraScene::CameraScene(const World& world)
    : signals_(world),
      ambient_(world.ambient_light),
      floor_grey_(world.arena.floor_grey),
      ring_(world.robots.size()),
      turret_(world.robots.size()),
      images_(floor_images(world)) {
    for (const Robot& robot : world.robots) {
        robots_.push_back(parameters_of(world, robot));
        const BodyParameters& body = robots_.back().robot;
        moving_.push_back({circle_shape(0, 0, body.radius, body.height, body.reflectivity)});
        poses_.push_back({robot.x, robot.y, robot.heading});
    }
    for (const Box& box : world.boxes) {
        if (!box.movable) continue;
        moving_.push_back({box_shape(0, 0, 0, box.length, box.width, box.height, box.reflectivity)});
        poses_.push_back({box.x, box.y, box.heading});
    }
    for (const Cylinder& can : world.cylinders) {
        if (!can.movable) continue;
        moving_.push_back({circle_shape(0, 0, can.radius, can.height, can.reflectivity)});
        poses_.push_back({can.x, can.y, 0.0});
    }
    for (const Shape& shape : fixed_shapes(world))
        fixed_.push_back(values_of(shape));
    for (const Patch& patch : world.patches) {
        patches_.push_back(values_of(patch, images_));
        seen_patches_.push_back(patch_from(patches_.back(), images_));
    }
    for (const Booth& booth : world.booths) {
        const BoothModel model(booth);  // which must outlive the loop over its lights
        for (const ColouredLight& light : model.lights())
            booth_lights_.push_back({light.x, light.y, light.z, light.radius});
    }
    for (const Lamp& lamp : world.lamps) {
        const double level = kLampLevel * lamp.intensity;
        lamps_.push_back({lamp.x, lamp.y, lamp.height, kLampRadius, {level, level, level}});
    }
}

void CameraScene::change_patch(std::size_t index, std::size_t part, double value) {
    grown(patches_, index)[part] = value;
    seen_patches_.clear();
    for (const auto& values : patches_)
        if (values[kCameraPatchValues - 1] != 0.0) seen_patches_.push_back(patch_from(values, images_));
}

void CameraScene::move_lamp(std::size_t index, std::size_t part, double value) {
    Glow& lamp = grown(lamps_, index);
    lamp.radius = kLampRadius;
    if (part == 0) lamp.x = value;
    if (part == 1) lamp.y = value;
    if (part == 2) lamp.z = value;
    if (part == 3) lamp.level.fill(kLampLevel * value);
}

void CameraScene::change(std::size_t id, double value) {
    using Kind = CameraSignals::Kind;
    const auto [kind, index, part] = signals_.meaning(id);
    switch (kind) {
    case Kind::Ambient:
        ambient_ = value;
        break;
    case Kind::FloorGrey:
        floor_grey_ = value;
        break;
    case Kind::Pose:
        (part == 0 ? poses_[index].x : part == 1 ? poses_[index].y : poses_[index].heading) = value;
        break;
    case Kind::Out:
        moving_[index].out = value != 0.0;
        break;
    case Kind::RingLed:
        ring_[index][part] = value;
        break;
    case Kind::Turret:
        turret_[index][part] = value;
        break;
    case Kind::Lamp:
        lamps_[index].level.fill(kLampLevel * value);
        break;
    case Kind::LampPlace:
        move_lamp(index, part, value);
        break;
    case Kind::BoothLight:
        booth_lights_[index].level[part] = value;
        break;
    case Kind::Fixed:
        grown(fixed_, index)[part] = value;
        break;
    case Kind::Added:
        grown(added_, index)[part] = value;
        break;
    case Kind::Patch:
        change_patch(index, part, value);
        break;
    }
}

void CameraScene::bodies(std::size_t but, std::vector<Body>& out) const {
    out.clear();
    for (const ShapeValues& values : fixed_)
        if (const Shape shape = shape_from(values); shape.height > 0.0) out.push_back(plain(shape));
    for (const ShapeValues& values : added_)
        if (const Shape shape = shape_from(values); shape.height > 0.0) out.push_back(plain(shape));
    for (std::size_t i = 0; i < moving_.size(); ++i) {
        if (i == but || moving_[i].out) continue;
        Shape shape = moving_[i].shape;
        shape.place(poses_[i].x, poses_[i].y, poses_[i].heading);
        if (i < robots_.size()) {
            out.push_back({shape, kRobotSide, kRobotTop, static_cast<int>(i)});
        } else {
            out.push_back(plain(shape));
        }
    }
}

void CameraScene::turret_glows(std::size_t robot, std::vector<Glow>& out) const {
    const Pose& pose = poses_[robot];
    const CameraParameters& camera = robots_[robot].camera;
    const double cosine = std::cos(pose.heading), sine = std::sin(pose.heading);
    for (std::size_t i = 0; i < kTurretPlace.size(); ++i) {
        const auto& [x, y] = kTurretPlace[i];
        Glow glow{pose.x + cosine * x - sine * y, pose.y + sine * x + cosine * y, kTurretHeight,
                  camera.turret_radius};
        for (std::size_t c = 0; c < 3; ++c)
            glow.level[c] = camera.turret_level * turret_[robot][3 * i + c];
        out.push_back(glow);
    }
}

void CameraScene::ring_glows(std::size_t robot, std::vector<Glow>& out) const {
    const Pose& pose = poses_[robot];
    const CameraParameters& camera = robots_[robot].camera;
    const double distance = robots_[robot].robot.radius + kRingOut;
    for (std::size_t led = 0; led < kRingLeds; ++led) {
        const double brightness = camera.ring_level * ring_[robot][led];
        if (brightness <= 0.0 || led == kBodyLed) continue;
        const double turn = led < kRing ? -std::numbers::pi / 4 * static_cast<double>(led) : 0.0;
        out.push_back({pose.x + distance * std::cos(pose.heading + turn),
                       pose.y + distance * std::sin(pose.heading + turn),
                       led == kFrontLed ? kFrontHeight : kRingHeight,
                       camera.ring_radius,
                       {brightness, 0.0, 0.0}});
    }
}

void CameraScene::glows(std::size_t but, std::vector<Glow>& out) const {
    out.clear();
    for (const Glow& lamp : lamps_)
        if (lamp.level[0] > 0.0) out.push_back(lamp);
    for (Glow light : booth_lights_) {
        for (double& level : light.level)
            level *= robots_[but].camera.booth_level;
        out.push_back(light);
    }
    for (std::size_t robot = 0; robot < robots_.size(); ++robot) {
        if (robot == but || moving_[robot].out) continue;
        ring_glows(robot, out);
        turret_glows(robot, out);
    }
    std::erase_if(out, [](const Glow& glow) { return glow.level == std::array<double, 3>{}; });
}

}  // namespace puckloop::physics
