#include "reproductions/trial.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "reproductions/runs/scratch_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

std::string script(const std::vector<ScriptLine>& commands) {
    std::string text;
    for (const ScriptLine& command : commands) {
        text += fmt::format("{:.6f}", command.seconds);
        for (const char character : command.text)
            text += fmt::format(" {:02x}", static_cast<unsigned char>(character));
        text += '\n';
    }
    return text;
}

/// Where it is spoken with.
const char* uart_of(const TrialRobot& robot) {
    return robot.bluetooth != 0 ? "uart2" : "uart1";
}

fs::path write_scenario(const TrialSpec& spec) {
    std::string text =
        fmt::format("[run]\nduration = \"{} s\"\nseed = {}\n[arena]\nsize = [\"{} m\", \"{} m\"]\n",
                    spec.seconds, spec.seed, spec.arena, spec.arena);
    for (const TrialRobot& robot : spec.robots) {
        write_file(spec.folder / (robot.name + ".txt"), script(robot.commands));
        text += fmt::format("[[robot]]\nname = \"{0}\"\nposition = [\"{1:.6f} m\", \"{2:.6f} m\"]\nheading = "
                            "\"{3:.6f} rad\"\n"
                            "[robot.pic]\nfirmware = \"{4}\"\nselector = {5}\n{6} = \"script:{0}.txt\"\n",
                            robot.name, robot.x, robot.y, robot.heading,
                            fs::absolute(robot.firmware).string(), robot.selector, uart_of(robot));
        if (robot.bluetooth != 0)
            text += fmt::format("[robot.pic.bluetooth]\nnumber = {}\n", robot.bluetooth);
    }
    const fs::path file = spec.folder / "trial.toml";
    write_file(file, text);
    return file;
}

/// The next field of a CSV line without quotes; `line` is left behind it.
std::string_view field(std::string_view& line) {
    const std::size_t comma = line.find(',');
    const std::string_view found = line.substr(0, comma);
    line.remove_prefix(comma == std::string_view::npos ? line.size() : comma + 1);
    return found;
}

/// Puts the characters of each robot's UART together to lines.
std::vector<std::vector<RobotLine>> read_lines(const fs::path& trace, const std::vector<TrialRobot>& robots) {
    std::vector<std::vector<RobotLine>> lines(robots.size());
    std::vector<RobotLine> open(robots.size());
    std::vector<std::string> names;
    for (const TrialRobot& robot : robots)
        names.push_back(fmt::format("{}.{}", robot.name, uart_of(robot)));
    std::ifstream stream(trace);
    for (std::string row; std::getline(stream, row);) {
        std::string_view rest = row;
        const std::string_view time = field(rest), link = field(rest), from = field(rest), kind = field(rest);
        if (kind != "uart") continue;
        for (std::size_t i = 0; i < robots.size(); ++i) {
            if (link != names[i] || from != robots[i].name + ".pic") continue;
            const auto character =
                static_cast<char>(std::strtoul(std::string(field(rest)).c_str(), nullptr, 16));
            if (character == '\r' || character == '\n') {
                if (!open[i].text.empty()) lines[i].push_back(std::move(open[i]));
                open[i] = {};
            } else {
                if (open[i].text.empty()) open[i].seconds = std::strtod(std::string(time).c_str(), nullptr);
                open[i].text += character;
            }
        }
    }
    return lines;
}

}  // namespace

physics::PathPoint Trial::at(std::size_t robot, double seconds) const {
    const auto& path = paths.at(robot);
    if (path.empty()) return {};
    const auto after =
        std::upper_bound(path.begin(), path.end(), seconds,
                         [](double s, const physics::PathPoint& point) { return s < point.seconds; });
    if (after == path.begin()) return path.front();
    if (after == path.end()) return path.back();
    const physics::PathPoint &a = *(after - 1), &b = *after;
    const double share = (seconds - a.seconds) / (b.seconds - a.seconds);
    return {seconds, a.x + share * (b.x - a.x), a.y + share * (b.y - a.y),
            a.heading + share * (b.heading - a.heading)};
}

Trial run_trial(const TrialSpec& spec) {
    empty_folder(spec.folder);
    const fs::path results = run_beside(write_scenario(spec), spec.overlay);
    Trial trial;
    trial.lines = read_lines(results / "trace.csv", spec.robots);
    const physics::Paths paths = physics::read_paths(results / "trajectory.csv");
    for (const TrialRobot& robot : spec.robots) {
        const auto found = std::find_if(paths.begin(), paths.end(),
                                        [&](const auto& path) { return path.first == robot.name; });
        trial.paths.push_back(found == paths.end() ? std::vector<physics::PathPoint>{} : found->second);
    }
    std::error_code ignored;
    fs::remove(results / "trace.csv", ignored);  // some 200 kB a second and robot
    return trial;
}

}  // namespace puckloop::tools
