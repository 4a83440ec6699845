#include "run/nodes/cameras.h"

#include <string>
#include <vector>

namespace puckloop::tools {

void add_cameras(const RunSetup& setup, std::size_t index, LinuxProgram& spec) {
    const scenarios::RobotBoards& robot = setup.scenario.robots[index];
    const scenarios::LinuxBoard& board = *robot.linux_board;
    if (board.cameras.empty()) return;
    std::vector<std::string> kinds;
    for (const scenarios::LinuxCamera& camera : board.cameras) {
        const std::string name = (setup.out / (robot.name + "." + camera.kind)).string();
        linuxboard::CameraSpec one;
        one.device = camera.device;
        one.card = camera.kind == "omni" ? "e-puck omnidirectional" : "e-puck front";
        one.log = name + ".csv";
        if (board.save_frames > 0) {
            one.save = name;
            one.save_every = static_cast<std::uint32_t>(board.save_frames);
        }
        spec.program.cameras.push_back(std::move(one));
        kinds.push_back(camera.kind);
    }
    spec.scenery = CameraViews{setup.scenario.world, index, std::move(kinds)};
}

void add_board_camera(RunSetup& setup, std::size_t index, MainBoard& spec) {
    const scenarios::RobotBoards& robot = setup.scenario.robots[index];
    if (robot.pic.camera.empty()) return;
    // Where results go decides nothing of what is seen.
    physics::World there = setup.scenario.world;
    there.recording.directory.clear();
    there.recording.log.clear();
    spec.camera = BoardCamera{robot.pic.camera, robot.pic.camera_turned, std::move(there), index};
    spec.i2c_hertz = setup.scenario.i2c_clock;
    spec.camera_log = (setup.out / (robot.name + ".pic.camera.csv")).string();
    cosim::LinkSpec seen{
        robot.name + ".camera", {robot.name + ".pic", "camera"}, {"world", robot.name + ".camera"}};
    seen.record_from_b = false;
    setup.links.push_back(seen);
    setup.links.push_back(
        {robot.name + ".i2c.camera", {robot.name + ".pic", "camera_i2c"}, {robot.name + ".i2c", "camera"}});
}

}  // namespace puckloop::tools
