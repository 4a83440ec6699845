#pragma once
// What else the machine did while something was measured: a figure taken beside other work states it.

#include <string>

namespace puckloop::tools {

struct OtherLoad {
    unsigned processors = 1;
    double busy = 0;            ///< processors busy with other work, mean over the measurement
    double average_before = 0;  ///< the kernel's load average over a minute, which counts our own work too
    double average_after = 0;

    std::string text() const;  ///< one line
};

/// Seconds that all processors of the machine were busy since it was started, of the first line of /proc/stat
/// (time stolen by other virtual machines included); 0 if it is none.
double busy_seconds(const std::string& stat_line, double ticks_per_second);

/// From its construction on.
class OtherLoadMeter {
  public:
    OtherLoadMeter();
    OtherLoad read() const;

  private:
    double busy_ = 0, own_ = 0, wall_ = 0, average_ = 0;
};

}  // namespace puckloop::tools
