#include "scenarios/tables/camera_keys.h"

#include "emu/camera/model.h"
#include "scenarios/tables/linux_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace puckloop::scenarios {

namespace {

/// `cameras` and the devices as which programs find them. ARGoS' program opens the omnidirectional one as
/// /dev/video1.
std::vector<LinuxCamera> cameras_of(Reader& reader) {
    std::vector<LinuxCamera> cameras;
    if (!reader.has("cameras")) return cameras;
    for (const std::string& kind : reader.texts("cameras")) {
        if (kind != "omni" && kind != "front")
            reader.fail("cameras", fmt::format("there is no camera '{}'", kind),
                        "\"omni\", \"front\" or both");
        for (const LinuxCamera& other : cameras)
            if (other.kind == kind) reader.fail("cameras", fmt::format("'{}' is there twice", kind));
        cameras.push_back({kind, kind == "omni" ? "/dev/video1" : "/dev/video0"});
    }
    if (!reader.has("camera_devices")) return cameras;
    const std::vector<std::string> devices = reader.texts("camera_devices");
    if (devices.size() != cameras.size())
        reader.fail("camera_devices", "camera_devices has not one name for each of cameras",
                    "as many, such as [\"/dev/video0\", \"/dev/video1\"]");
    for (std::size_t i = 0; i < devices.size(); ++i) {
        check_device_name(reader, "camera_devices", devices[i], "/dev/video0");
        for (std::size_t k = 0; k < i; ++k)
            if (devices[k] == devices[i])
                reader.fail("camera_devices", fmt::format("'{}' is there twice", devices[i]));
        cameras[i].device = devices[i];
    }
    return cameras;
}

}  // namespace

void read_cameras(Reader& reader, LinuxBoard& board) {
    board.cameras = cameras_of(reader);
    // The serial port and the I2C bus of the same board would no longer be found.
    for (const LinuxCamera& camera : board.cameras)
        for (const auto* others : {&board.serial_devices, &board.i2c_devices})
            if (std::find(others->begin(), others->end(), camera.device) != others->end())
                reader.fail(reader.has("camera_devices") ? "camera_devices" : "cameras",
                            fmt::format("'{}' is another device of the board", camera.device),
                            "a path such as /dev/video0");
    constexpr std::int64_t kRarest = 1'000'000;
    if (!board.cameras.empty()) board.save_frames = reader.integer("save_frames", 0, 0, kRarest);
}

std::string read_board_camera(Reader& reader) {
    const std::string name = reader.text("camera", "none");
    if (name == "none") return {};
    if (!camera::model_of(name))
        reader.fail("camera", fmt::format("there is no camera '{}'", name),
                    "po3030k, po6030k, po8030d or none");
    return name;
}

}  // namespace puckloop::scenarios
