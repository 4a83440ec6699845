#include "tools/run/camera_scenery.h"

#include "physics/camera/camera_view.h"

#include <nlohmann/json.hpp>

#include <deque>
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

}  // namespace

std::unique_ptr<linuxboard::Scenery> make_scenery(const nlohmann::json& spec) {
    return std::make_unique<RobotScenery>(physics::from_json(spec.at("world").dump()),
                                          spec.at("robot").get<std::size_t>(),
                                          spec.at("kinds").get<std::vector<std::string>>());
}

}  // namespace puckloop::tools
