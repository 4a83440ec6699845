#include "selftest/emulate/stage.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/text/csv.h"
#include "gap/data/written.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "scenarios/tables/world_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>

namespace puckloop::gap::emulate {

namespace {

constexpr double kStart = 0.2;  // s: the firmware is ready after 14 ms
constexpr const char* kEvery = "10 ms";

/// A path as a TOML text.
std::string quoted(const std::filesystem::path& path) {
    std::string out = "\"";
    for (const char c : path.string()) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
            out += fmt::format("\\u{:04x}", static_cast<int>(c));
            continue;
        }
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

std::string scenario_text(const Robot& robot, const Act& act, const Tools& tools, std::uint64_t seed,
                          const std::filesystem::path& scratch) {
    std::string text =
        fmt::format("[run]\nseed = {}\nrecord_every = \"{}\"\n{}\n[parameters]\n", seed, kEvery, act.arena);
    auto parameters = robot.parameters;
    if (act.load != 0.0) parameters["robot.load"] += act.load;
    if (act.slope_x != 0.0) parameters["world.slope_x"] += act.slope_x;
    if (act.slope_y != 0.0) parameters["world.slope_y"] += act.slope_y;
    if (act.shimmed) parameters["robot.skid_clearance"] = 0.0;
    for (const auto& [name, value] : parameters)
        text += fmt::format("{} = {}\n", name, scenarios::parameter_text(name, value));
    text +=
        fmt::format("[[robot]]\nname = \"robot0\"\nposition = [\"{} m\", \"{} m\"]\nheading = \"{} rad\"\n",
                    act.x, act.y, act.heading);
    text += fmt::format("[robot.pic]\nfirmware = {}\ncrystal_error = \"{} ppm\"\n",
                        quoted(robot.firmware.empty() ? tools.firmware : robot.firmware), robot.crystal_ppm);
    text += fmt::format("[robot.linux]\nprogram = [{}, \"--script\", {}, \"--log\", {}, \"--period\", \"{}\"",
                        quoted(tools.record), quoted(scratch / "commands.txt"),
                        quoted(scratch / "records.csv"), robot.period);
    if (act.ground)
        text += fmt::format(", \"--i2c\", \"/dev/i2c-3\", \"--ground-every\", \"{}\"", act.ground_every);
    if (act.relative) text += ", \"--relative\"";
    text += fmt::format("]\nstart = \"{} s\"\n", kStart);
    const auto late = [&](const char* key, double seconds) {
        if (seconds != 0) text += fmt::format("{} = \"{} s\"\n", key, seconds);
    };
    late("tty_batch", robot.lateness.tty_batch);
    late("i2c_hold", robot.lateness.i2c_hold);
    late("oversleep", robot.lateness.oversleep);
    late("oversleep_jitter", robot.lateness.oversleep_jitter);
    const auto fault = [&](const std::string& more, const char* from = "robot0.pic") {
        text += fmt::format("[[fault]]\nlink = \"robot0.uart\"\nfrom = \"{}\"\nmay_not_fire = true\n{}", from,
                            more);
    };
    if (robot.uart_factor != 1.0) fault(fmt::format("kind = \"rate\"\nfactor = {}\n", robot.uart_factor));
    if (robot.uart_loss > 0.0) fault(fmt::format("kind = \"drop\"\nprobability = {}\n", robot.uart_loss));
    if (robot.uart_cut > 0.0)
        fault(fmt::format("kind = \"cut\"\nprobability = {}\nagain = {}\n", robot.uart_cut,
                          robot.uart_cut_again));
    if (robot.uart_edge_loss > 0.0)
        fault(fmt::format("kind = \"drop\"\nbytes = [\"0x00\", \"0xFF\"]\nprobability = {}\n",
                          robot.uart_edge_loss));
    if (robot.uart_delay > 0.0)
        fault(fmt::format("kind = \"delay\"\ndelay = \"{} s\"\n", robot.uart_delay), "robot0.linux");
    return text;
}

/// Cells of a CSV line; empty ones are NaN.
std::vector<double> cells(const std::string& line) {
    std::vector<double> values;
    for (const auto cell : csv_cells(line, ','))
        if (double value = 0.0; csv_number(cell, value))
            values.push_back(value);
        else
            values.push_back(std::numeric_limits<double>::quiet_NaN());
    return values;
}

struct Pose {
    double t, x, y, theta;
};

std::vector<Pose> read_path(const std::filesystem::path& file) {
    std::ifstream in(file);
    std::vector<Pose> path;
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
        const auto c = cells(line);
        if (c.size() >= 5) path.push_back({c[0], c[2], c[3], c[4]});
    }
    if (path.empty()) throw RunError(file.string() + ": no pose recorded");
    return path;
}

Pose pose_at(const std::vector<Pose>& path, double t) {
    const auto after =
        std::upper_bound(path.begin(), path.end(), t, [](double time, const Pose& p) { return time < p.t; });
    if (after == path.begin()) return path.front();
    if (after == path.end()) return path.back();
    const Pose& a = *(after - 1);
    const double f = (t - a.t) / (after->t - a.t);
    return {t, a.x + f * (after->x - a.x), a.y + f * (after->y - a.y),
            a.theta + f * (after->theta - a.theta)};
}

/// Mean over an exposure around t, as a camera sees a marker that moves. Headings in the file are not wrapped
/// within so short a time, or the mean would fall between two turns.
Pose seen_at(const std::vector<Pose>& path, double t, double exposure) {
    if (!(exposure > 0)) return pose_at(path, t);
    constexpr int kLooks = 9;
    const Pose middle = pose_at(path, t);
    Pose mean{t, 0, 0, 0};
    for (int look = 0; look < kLooks; ++look) {
        const Pose pose = pose_at(path, t + exposure * (look / (kLooks - 1.0) - 0.5));
        mean.x += pose.x / kLooks;
        mean.y += pose.y / kLooks;
        mean.theta += std::remainder(pose.theta - middle.theta, 2 * std::numbers::pi) / kLooks;
    }
    mean.theta += middle.theta;
    return mean;
}

}  // namespace

std::vector<Row> perform(const Robot& robot, const Act& act, const Tools& tools, std::uint64_t seed,
                         const std::filesystem::path& scratch) {
    std::filesystem::create_directories(scratch);
    std::string script;
    for (const auto& c : act.commands)
        script += fmt::format("{} {} {}\n", c.seconds, c.left, c.right);
    write_file(scratch / "commands.txt", script);
    write_file(scratch / "scenario.toml", scenario_text(robot, act, tools, seed, scratch));
    tools::RunRequest request;
    request.scenario = scratch / "scenario.toml";
    request.out = scratch / "out";
    request.in_process = true;
    request.overlay = robot.overlay;
    const auto setup = tools::set_up(request);
    const auto outcome = tools::run_scenario(setup, request, {}, nullptr);
    if (!outcome.success) throw RunError("recording on the emulator failed: " + outcome.text);

    const auto path = read_path(scratch / "out" / "trajectory.csv");
    std::ifstream in(scratch / "records.csv");
    std::string line;
    std::getline(in, line);
    constexpr std::size_t kCells = 6 + 8 + 8 + 3 + 3 + 3;
    std::vector<Row> rows;
    double begun = 0.0, shift = 0.0;
    while (std::getline(in, line)) {
        auto c = cells(line);
        c.resize(kCells, std::numeric_limits<double>::quiet_NaN());
        if (rows.empty()) {
            begun = c[0];
            shift = std::floor(begun / 60.0) * 60.0;  // the board's clock stood at 60 s when power came
        }
        const Pose pose = seen_at(path, c[0] - shift, robot.tracker_exposure);
        Row row{c[0] - begun, c[3] - begun, c[0] - shift, c[1], c[2], pose.x, pose.y,
                pose.theta,   c[4] == 1.0,  {},           {},   {},   {},     {}};
        std::copy_n(c.begin() + 6, 8, row.ps);
        std::copy_n(c.begin() + 14, 8, row.amb);
        std::copy_n(c.begin() + 22, 3, row.gs);
        std::copy_n(c.begin() + 25, 3, row.acc);
        std::copy_n(c.begin() + 28, 3, row.mic);
        rows.push_back(row);
    }
    if (rows.empty()) throw RunError("recording on the emulator gave no row");
    // Given up and begun anew each time, the script would run several times slower than it says.
    const auto answered = std::count_if(rows.begin(), rows.end(), [](const Row& row) { return row.ok; });
    if (2 * static_cast<std::size_t>(answered) < rows.size())
        throw RunError(fmt::format("recording on the emulator: the main board answered {} of {} exchanges",
                                   answered, rows.size()));
    return rows;
}

}  // namespace puckloop::gap::emulate
