#pragma once
// What a run did, from its results folder: as much as an outcome is judged by.

#include "base/json.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace puckloop::faults {

/// What one node sent on one link.
struct Sender {
    std::vector<double> times;        ///< s, of every frame's begin, ascending
    std::vector<std::string> values;  ///< of every frame, as in the trace
    std::vector<double> frame_s;      ///< of every frame: what it takes on the wire; 0 where unknown
    std::set<std::string> addresses;  ///< I2C: first bytes of transfers, hexadecimal
};

struct Pose {
    double x = 0, y = 0;  ///< m
};

struct Profile {
    nlohmann::json report;
    std::map<std::string, Sender> senders;             ///< by "link from node"
    std::map<std::string, std::vector<double>> turns;  ///< by robot: when a wheel turned, s, ascending
    std::map<std::string, std::map<std::string, Pose>> paths;  ///< by robot, then by time as written
    std::map<std::string, std::vector<std::string>> logs;      ///< of programs, by node: the lines
    std::set<std::string> log_shapes;                          ///< "robot0.linux: line without digits"
    std::map<std::string, double> error_counters;              ///< of the report and of programs' logs
    std::optional<double> first_fault_s;                       ///< first frame that the trace marks
};

/// Reads report.json, trace.csv, trajectory.csv and the programs' logs. Throws RunError where the report is
/// missing or damaged.
Profile read_profile(const std::filesystem::path& folder);

/// "link from node", the key of Profile::senders.
std::string sender_name(const std::string& link, const std::string& from);

/// A log's line without colours and with every number as '#'.
std::string shape_of(const std::string& line);

/// True of names of counters that count errors: "framing_errors", "overruns", "stray bytes".
bool names_error(const std::string& name);

/// Length of a robot's path, m; none where it has none.
std::optional<double> path_length(const Profile& profile, const std::string& robot);

}  // namespace puckloop::faults
