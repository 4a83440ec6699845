#pragma once
// How long a run of many robots would take on many machines, from what short runs on this one have measured.

#include <span>
#include <vector>

namespace puckloop::tools {

/// Of a run on several ranks, for a simulated second.
struct HostCost {
    double robots = 0;
    double conductor_s = 0;  ///< wall time in which the conductor worked
    double boards_s = 0;     ///< processor time of all nodes on the other ranks and their programs
    double waits = 0;        ///< how often the conductor had nothing to do but wait for an answer
};

/// A straight line.
struct StraightLine {
    double at_zero = 0, slope = 0;

    double at(double x) const { return at_zero + slope * x; }
};

/// A robot's share grows with the number of robots, as the conductor looks at all nodes in each round.
struct HostModel {
    StraightLine conductor_per_robot;  ///< s
    double boards_per_robot = 0;
    StraightLine waits;
};

/// Through two runs of different size.
HostModel host_model(const HostCost& few, const HostCost& many);

struct HostEstimate {
    double real_time_factor = 0;
    const char* limit = "";  ///< "conductor", "boards" or "latency": what takes longest
};

/// `cores` of each host carry out nodes; a message takes `latency_s` there and back. Nodes work while the
/// conductor waits, and not faster than either the cores or the messages allow.
HostEstimate estimate(const HostModel& model, double robots, double hosts, double cores, double latency_s);

}  // namespace puckloop::tools
