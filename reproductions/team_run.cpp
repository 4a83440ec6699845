// A run of a team: its scenario, and the messages in its trace.

#include "reproductions/pause_times.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/random.h"
#include "reproductions/runs/scratch_run.h"
#include "traces/recorded_trace.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

constexpr double kFieldWidth = 2.0, kFieldDepth = 1.8;   // m
constexpr double kFromWall = 0.15, kRobotsApart = 0.15;  // m, of robots at the beginning
constexpr const char* kManager = "manager";
/// s: until forwarders are connected (the firmware's first message is later than 2 s), and what a receive
/// call waits at most.
constexpr double kConnecting = 4.0, kReceiving = 3.0;

struct StartPose {
    double x = 0, y = 0, heading = 0;
};

std::vector<StartPose> draw_poses(const TeamSpec& spec) {
    RandomStream random(spec.seed, "team poses");
    std::vector<StartPose> poses;
    while (poses.size() < static_cast<std::size_t>(spec.robots)) {
        StartPose pose{(random.uniform() - 0.5) * (kFieldWidth - 2 * kFromWall),
                       (random.uniform() - 0.5) * (kFieldDepth - 2 * kFromWall), 0};
        bool free = true;
        for (const StartPose& other : poses)
            free = free && std::hypot(pose.x - other.x, pose.y - other.y) >= kRobotsApart;
        if (!free) continue;
        pose.heading = random.uniform() * 360;
        poses.push_back(pose);
    }
    return poses;
}

std::string quoted(const std::vector<std::string>& words) {
    std::string list;
    for (const std::string& word : words)
        list += fmt::format("{}\"{}\"", list.empty() ? "" : ", ", word);
    return list;
}

fs::path write_team(const TeamSpec& spec) {
    std::string text =
        fmt::format("[run]\nduration = \"{} s\"\nseed = {}\n[arena]\nsize = [\"{} m\", \"{} m\"]\n"
                    "[network]\nmode = \"wifi\"\naccess_point = [\"3 m\", \"0 m\"]\n"
                    "[network.wifi]\nstandard = \"{}\"\nrate = \"{:g} Mbit/s\"\n"
                    "[[host]]\nname = \"{}\"\nprogram = [\"puckloop-netmanager\"]\n",
                    spec.seconds, spec.seed, kFieldWidth, kFieldDepth, spec.standard, spec.rate, kManager);
    std::vector<std::string> program = spec.forwarder;
    program.insert(program.end(), {"--server", fmt::format("{}:7700", kManager)});
    for (const StartPose& pose : draw_poses(spec))
        text +=
            fmt::format("[[robot]]\nposition = [\"{:.4f} m\", \"{:.4f} m\"]\nheading = \"{:.2f} deg\"\n"
                        "[robot.pic]\nfirmware = \"{}\"\nselector = 10\n[robot.linux]\nprogram = [{}]\n",
                        pose.x, pose.y, pose.heading, fs::absolute(spec.firmware).string(), quoted(program));
    const fs::path file = spec.folder / "team.toml";
    write_file(file, text);
    return file;
}

}  // namespace

std::vector<Pause> run_team(const TeamSpec& spec) {
    empty_folder(spec.folder);
    const fs::path results = run_beside(write_team(spec));
    TeamTrace team(static_cast<std::size_t>(spec.robots), kManager);
    TraceSelection selection;
    selection.kinds = {"uart", "packet"};
    RecordedTrace(results, selection).for_each_checked([&](const cosim::TraceRow& row) { team.add(row); });
    if (team.messages().empty())
        throw RunError("no robot sent a message to all over UART2: the image must do as firmware/network");
    std::error_code ignored;
    fs::remove(results / "trace.csv", ignored);  // some 100 kB a second and robot
    return pauses_of(team.messages(), kConnecting, spec.seconds - kReceiving);
}

}  // namespace puckloop::tools
