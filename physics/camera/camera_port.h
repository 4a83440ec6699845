#pragma once
// The world's side of the camera ports: what changed since the last frame, to each robot with a camera.

#include "cosim/core/message.h"
#include "physics/camera/camera_signals.h"
#include "physics/world/world_model.h"

#include <map>
#include <vector>

namespace puckloop::physics {

class CameraPort {
  public:
    /// `ports`: of the robots with cameras.
    CameraPort(const WorldModel& model, std::vector<cosim::PortIndex> ports);

    /// A LED of a robot: on its main board, or (`turret`) on its I2C bus. Other signals are ignored.
    void led(std::size_t robot, bool turret, std::uint16_t id, double value);
    /// What the cameras' next frame sees is as of the step whose messages are stamped `stamp`: publishes what
    /// changed. `events`: things other than poses can have changed.
    void publish(const WorldModel& model, bool events, cosim::Time stamp,
                 std::vector<cosim::Message>& outbox);

  private:
    void put(std::size_t id, double value);
    void put_shape(bool fixed, std::size_t index, const Shape& shape);
    void put_poses(const WorldModel& model);
    void put_lamps(const World& world);
    void put_changes(const WorldModel& model);

    CameraSignals signals_;
    std::vector<FloorImage> images_;
    std::vector<cosim::PortIndex> ports_;
    std::vector<std::map<std::uint16_t, std::size_t>> ring_, turret_;  // by robot: signal id to ours
    std::map<std::size_t, double> leds_;
    std::map<std::size_t, double> last_;   // as published, or as described
    std::size_t patches_ = 0, lamps_ = 0;  // described or published so far
    cosim::Time stamp_ = 0;
    std::vector<cosim::Message>* outbox_ = nullptr;
};

}  // namespace puckloop::physics
