#pragma once
// tracker.csv: what the tracker saw, a row for each robot of a frame.

#include "physics/tracker/tracker.h"
#include "physics/world/recorder.h"

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::physics {

/// "t_s,arrives_s,frame,robot,x_m,y_m,theta_rad": when the cameras saw it, when it arrives, the frame's
/// number from 0, and the robot that the tracker takes it for. A robot that is lost has no row.
class TrackerRecord {
  public:
    /// Throws RunError, as add() does.
    TrackerRecord(const std::string& path, const World& world);
    void add(const TrackerFrame& frame);

  private:
    CsvFile file_;
    std::vector<std::string> names_;
};

}  // namespace puckloop::physics
