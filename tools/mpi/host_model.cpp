#include "tools/mpi/host_model.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

/// No slope but up: what is measured once scatters, and no cost falls below none.
StraightLine through(double x1, double y1, double x2, double y2) {
    const double slope = std::max(0.0, (y2 - y1) / (x2 - x1));
    if (slope == 0.0) return {0.5 * (y1 + y2), 0.0};
    const double at_zero = y1 - slope * x1;
    return at_zero >= 0.0 ? StraightLine{at_zero, slope} : StraightLine{0.0, y2 / x2};
}

}  // namespace

HostModel host_model(const HostCost& few, const HostCost& many) {
    return {through(few.robots, few.conductor_s / few.robots, many.robots, many.conductor_s / many.robots),
            (few.boards_s + many.boards_s) / (few.robots + many.robots),
            through(few.robots, few.waits, many.robots, many.waits)};
}

HostEstimate estimate(const HostModel& model, double robots, double hosts, double cores, double latency_s) {
    const double conductor = robots * model.conductor_per_robot.at(robots);
    const double boards = model.boards_per_robot * robots / std::min(hosts * cores, robots);
    const double latency = model.waits.at(robots) * latency_s;
    const double longest = std::max({conductor, boards, latency});
    const char* limit = longest == conductor ? "conductor" : longest == boards ? "boards" : "latency";
    return {1.0 / (conductor + std::max(boards, latency)), limit};
}

}  // namespace puckloop::tools
