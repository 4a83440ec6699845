#pragma once
// The coloured lights that a robot's omnidirectional camera sees, for behaviours.

#include "linuxboard/control/behaviours/behaviour.h"
#include "linuxboard/control/behaviours/colour_blobs.h"
#include "linuxboard/control/devices/video_camera.h"

#include <string>
#include <vector>

namespace puckloop::control {

class ColouredSpots {
  public:
    /// Starts the camera. Throws std::runtime_error naming the device.
    explicit ColouredSpots(const std::string& device);

    /// What its newest picture shows, largest first; nothing before the first one. Throws
    /// std::runtime_error when the camera fails.
    std::vector<ColouredSpot> look();
    const VideoCamera& camera() const { return camera_; }

  private:
    VideoCamera camera_;
    MirrorCalibration mirror_;
};

}  // namespace puckloop::control
