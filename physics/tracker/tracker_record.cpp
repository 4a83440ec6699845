#include "physics/tracker/tracker_record.h"

#include <fmt/format.h>

namespace puckloop::physics {

TrackerRecord::TrackerRecord(const std::string& path, const World& world)
    : file_(path, "t_s,arrives_s,frame,robot,x_m,y_m,theta_rad") {
    for (const Robot& robot : world.robots)
        names_.push_back(robot.name);
}

void TrackerRecord::add(const TrackerFrame& frame) {
    for (const TrackedRobot& robot : frame.robots)
        file_.row(fmt::format("{:.3f},{:.3f},{},{},{:.5f},{:.5f},{:.4f}",
                              static_cast<double>(frame.step) * 1e-3,
                              static_cast<double>(frame.arrives) * 1e-3, frame.number, names_[robot.robot],
                              robot.x, robot.y, robot.heading));
    file_.flush();
}

}  // namespace puckloop::physics
