#include "run/factory/camera_scenery.h"

#include "physics/camera/camera_view.h"
#include "physics/description/robot_parameters.h"

#include <cmath>
#include <deque>
#include <map>
#include <optional>
#include <string>

namespace puckloop::tools {

namespace {

class RobotScenery final : public linuxboard::Scenery {
  public:
    RobotScenery(const physics::World& world, std::size_t robot, const std::vector<std::string>& kinds)
        : scene_(world) {
        for (const std::string& kind : kinds)
            views_.emplace_back(kind == "omni" ? physics::CameraKind::Omni : physics::CameraKind::Front,
                                scene_, robot, world.robots.at(robot).name, world.seed);
    }

    void change(std::uint16_t id, double value) override { scene_.change(id, value); }

    void render(std::size_t camera, const linuxboard::PictureSettings& settings, cosim::Time,
                std::uint64_t frame, std::span<std::uint8_t> rgb) override {
        const physics::Exposure exposure{settings.gain,       settings.brightness, settings.contrast,
                                         settings.saturation, settings.mirror,     settings.flip};
        views_.at(camera).render({settings.width, settings.height}, exposure, frame, rgb);
    }

  private:
    physics::CameraScene scene_;
    std::deque<physics::CameraView> views_;
};

/// Goes back by a copy of what had been seen before the first change behind a mark.
class BoardScenery final : public camera::Scenery {
  public:
    BoardScenery(const physics::World& world, std::size_t robot)
        : now_{physics::CameraScene(world), {}},
          view_(physics::CameraKind::Front, now_.scene, robot, world.robots.at(robot).name, world.seed) {}

    void render(std::uint32_t width, std::uint32_t height, std::uint64_t frame,
                std::span<std::uint8_t> rgb) override {
        view_.render({width, height}, {}, frame, rgb);
    }
    void change(std::uint16_t id, double value) override {
        if (marked_ && !before_) before_ = now_;
        now_.scene.change(id, value);
        now_.changes[id] = value;
    }
    void mark() override {
        marked_ = true;
        before_.reset();
    }
    void rewind() override {
        if (before_) now_ = *before_;
        before_.reset();
    }
    void settle() override {
        marked_ = false;
        before_.reset();
    }
    std::map<std::uint16_t, double> changes() const override { return now_.changes; }
    void restore(const std::map<std::uint16_t, double>& changes) override {
        for (const auto& [id, value] : changes)
            change(id, value);
    }

  private:
    struct Seen {
        physics::CameraScene scene;
        std::map<std::uint16_t, double> changes;
    };
    Seen now_;
    std::optional<Seen> before_;
    bool marked_ = false;
    physics::CameraView view_;
};

/// The description's angle is the width of 640 columns in a picture of 480 rows; one of 640 rows needs more
/// for the same scale.
void widen_view(physics::World& world, std::size_t robot) {
    constexpr double kMoreRows = 640.0 / 480.0;
    physics::Robot& body = world.robots.at(robot);
    const double angle = physics::parameters_of(world, body).camera.front_fov;
    body.parameters["camera.front_fov"] = 2 * std::atan(std::tan(angle / 2) * kMoreRows);
}

}  // namespace

std::unique_ptr<linuxboard::Scenery> make_scenery(const CameraViews& views) {
    return std::make_unique<RobotScenery>(views.world, views.robot, views.kinds);
}

std::unique_ptr<camera::Scenery> make_board_scenery(const BoardCamera& camera) {
    physics::World world = camera.world;
    if (camera.turned) widen_view(world, camera.robot);
    return std::make_unique<BoardScenery>(world, camera.robot);
}

}  // namespace puckloop::tools
