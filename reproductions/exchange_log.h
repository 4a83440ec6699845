#pragma once
// What a robot's image writes about its exchanges by Bluetooth (firmware/bluetooth/README.md): "named
// e-puck_1234 in 2400 ms", "linked in 9800 ms", "answered", "released in 1000 ms", "exchange 20100 ms", or
// what failed.

#include "reproductions/trial.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

struct ReportedExchange {
    double seconds = 0.0;                                      ///< when its outcome was written
    std::optional<double> name{}, link{}, release{}, total{};  ///< s, by the robot's clock
    bool answered = false;                                     ///< by the other robot
    std::string failure{};  ///< "nobody found", "no name", "not linked"; empty: it came to its release

    bool succeeded() const { return failure.empty() && answered; }
};

/// Those that have ended, in order; other lines are ignored.
std::vector<ReportedExchange> read_exchanges(const std::vector<RobotLine>& lines);

}  // namespace puckloop::tools
