// thymio_ground_vicon_epfl: a Thymio II driving under motion capture; its published odometry pose beside the
// true one. From epfl-mobots/thymio-ground-localisation, LGPL-3.
// Rows have no times; 1/3 s apart is what the set's description says.

#include "base/error.h"
#include "gap/importers/importers.h"
#include "gap/importers/text_table.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::importers {

namespace {

constexpr const char* kRuns = "*/odom_quaternion.txt";
constexpr double kPeriod = 1.0 / 3;     // s
constexpr double kAxle = 0.095;         // m, of a Thymio II
constexpr double kWheelRadius = 0.022;  // m
constexpr double kCount = 1e-5;         // m a reckoned count

/// What the wheels must have travelled for the odometry to move as it did, in counts.
std::pair<std::vector<double>, std::vector<double>>
wheel_counts(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& heading) {
    std::vector<double> left{0.0}, right{0.0};
    for (std::size_t i = 1; i < x.size(); ++i) {
        const double turn = std::remainder(heading[i] - heading[i - 1], 2 * std::numbers::pi);
        const double middle = heading[i - 1] + turn / 2;
        const double ahead = (x[i] - x[i - 1]) * std::cos(middle) + (y[i] - y[i - 1]) * std::sin(middle);
        left.push_back(left.back() + (ahead - turn * kAxle / 2) / kCount);
        right.push_back(right.back() + (ahead + turn * kAxle / 2) / kCount);
    }
    return {left, right};
}

WrittenRun read_vicon_run(const std::filesystem::path& folder) {
    const auto truth = read_numbers(folder / "gt.txt", ' ', 3);
    const auto pose = read_numbers(folder / "odom_pose.txt", ' ', 2);
    const auto turn = read_numbers(folder / "odom_quaternion.txt", ' ', 2);
    const std::size_t rows = truth[0].size();
    for (const auto& [table, file] : {std::pair{&pose, "odom_pose.txt"}, {&turn, "odom_quaternion.txt"}})
        if (table->front().size() != rows)
            throw InputError((folder / file).string(), "", fmt::format("has {} rows", table->front().size()),
                             fmt::format("{}, as gt.txt", rows));
    std::vector<double> heading, time;
    for (std::size_t i = 0; i < rows; ++i) {
        heading.push_back(2 * std::atan2(turn[0][i], turn[1][i]));
        time.push_back(static_cast<double>(i) * kPeriod);
    }
    auto [left, right] = wheel_counts(pose[0], pose[1], heading);
    WrittenRun run;
    run.name = folder.filename().string();
    run.columns = {{"t_s", time},           {"x_m", truth[0]},    {"y_m", truth[1]},
                   {"theta_rad", truth[2]}, {"steps_left", left}, {"steps_right", right}};
    return run;
}

std::vector<WrittenExperiment> read_thymio_vicon(const std::filesystem::path& folder) {
    WrittenExperiment e;
    e.folder = "thymio_vicon_motion";
    e.kind = "motion";
    e.title = "Thymio II under motion capture, odometry against truth";
    e.robot = "Thymio II";
    e.description =
        "Wheel counts (0.01 mm) are reckoned back from the authors' odometry poses with an axle of 95 mm: "
        "what is found corrects their odometry. Rows are taken 1/3 s apart. The floor picture is not in the "
        "set, so the ground sensors have no truth and are left out. Geared motors change the speed by 0.1 "
        "m/s2 at most: no tyre slides, so the e-puck's sliding is off.";
    e.source = "github.com/epfl-mobots/thymio-ground-localisation";
    e.licence = "LGPL-3";
    e.nominal = {{"robot.wheel_radius_left", kWheelRadius},
                 {"robot.wheel_radius_right", kWheelRadius},
                 {"robot.axle_length", kAxle},
                 {"inverse_friction", 0.0},
                 {"robot.steps_per_turn", 2 * std::numbers::pi * kWheelRadius / kCount}};
    for (const auto& turns : paths_like(folder, kRuns)) {
        const auto run = turns.parent_path();
        if (std::filesystem::exists(run / "gt.txt") && std::filesystem::exists(run / "odom_pose.txt"))
            e.runs.push_back(read_vicon_run(run));
    }
    return {e};
}

}  // namespace

const Importer kThymioVicon{"thymio_ground_vicon_epfl", "Thymio II odometry under motion capture",
                            "folders with gt.txt, odom_pose.txt, odom_quaternion.txt", kRuns,
                            read_thymio_vicon};

}  // namespace puckloop::gap::importers
