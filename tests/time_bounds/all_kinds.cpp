// A scenario with nodes of every kind beside one another, and events in their world.

#include "tests/time_bounds/scenarios.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <vector>

namespace puckloop::tests {

namespace {

constexpr double kEnd = 1.5;
constexpr int kRobots = 3;

std::string linux_board(Draw& draw, int place, bool ircom) {
    std::string text = fmt::format(
        "[robot.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", \"{}\", \"--rab-id\", \"{}\"",
        draw.of(std::array{"follow", "wander"}), place + 1);
    if (ircom) text += fmt::format(", \"--ircom-send\", \"0xb{}\", \"--ircom-every\", \"0.2\"", place);
    text += fmt::format("]\nstart = {}\n", draw.time(0.02, 0.5));
    if (draw.one_in(3)) text += fmt::format("restart = [{}]\n", draw.time(0.6, kEnd));
    if (draw.one_in(3)) text += fmt::format("tty_batch = {}\n", draw.time(0.001, 0.02));
    if (draw.one_in(4)) text += "cameras = [\"front\"]\n";
    return text;
}

struct Kind {
    const char* firmware;
    const char* keys;
    bool has_linux, ircom;
};
constexpr std::array kKinds{
    Kind{"epuck/epuck.hex", "", true, false},
    Kind{"epuck/epuck_ircom.hex", "", true, true},
    Kind{"bluetooth/talk.hex", "uart2 = \"script:/dev/null\"\n[robot.pic.bluetooth]\n", false, false},
    Kind{"can/can.hex", "", false, false},
    Kind{"camera/camera.hex", "camera = \"po3030k\"\n", false, false},
    Kind{"sound/sound.hex", "uart1 = \"script:/dev/null\"\n", false, false},
};

std::string events(Draw& draw) {
    std::string text;
    for (std::uint64_t i = draw.below(5); i > 0; --i) {
        const std::string name = fmt::format("r{}", draw.below(kRobots));
        const std::array<std::string, 8> actions{
            fmt::format("lift = \"{}\"", name),
            fmt::format("put = \"{}\"\nto = [\"{:.1f} cm\", \"-45 cm\"]", name, draw.uniform(-70, 70)),
            fmt::format("move = \"{}\"\nto = [\"{:.1f} cm\", \"-45 cm\"]\nover = {}", name,
                        draw.uniform(-70, 70), draw.time(0.01, 0.5)),
            fmt::format("reset = \"{}\"", name),
            fmt::format("select = \"{}\"\nposition = {}", name, draw.below(16)),
            fmt::format("remote = \"all\"\nkey = {}", draw.below(64)),
            fmt::format("set = \"light\"\nambient = {:.2f}", draw.uniform(0, 12)),
            fmt::format("set = \"{}\"\ncharge = {:.2f}", name, draw.uniform(0, 1)),
        };
        text += fmt::format("[[event]]\nat = {}\n{}\n", draw.time(0, kEnd), draw.of(actions));
    }
    return text;
}

}  // namespace

DrawnScenario draw_all(Draw& draw, bool with_tams) {
    DrawnScenario drawn;
    drawn.seconds = kEnd;
    drawn.toml = drawn_head(draw, 1.6, 1.2);
    std::vector<std::string> controllers;
    for (int i = 0; i < kRobots; ++i) {
        const Kind kind = draw.of(kKinds);
        drawn.toml +=
            drawn_robot(draw, i, kind.firmware, fmt::format("selector = {}\n{}", draw.below(3), kind.keys));
        if (kind.firmware == std::string("can/can.hex"))
            controllers.push_back(fmt::format("\"r{}.pic.can1\"", i));
        if (draw.one_in(2))
            drawn.toml +=
                fmt::format("[robot.rab]\nfirmware = \"{}/firmware/rab/rab.hex\"\n", PUCKLOOP_SOURCE);
        if (kind.has_linux && !draw.one_in(4)) drawn.toml += linux_board(draw, i, kind.ircom);
    }
    if (!controllers.empty())
        drawn.toml += fmt::format("[[can_bus]]\ncontrollers = [{}]\n", fmt::join(controllers, ", "));
    const int tams = with_tams ? static_cast<int>(draw.below(3)) : 0;
    for (int i = 0; i < tams; ++i)
        drawn.toml += drawn_tam(draw, i, kEnd);
    if (tams == 0 && draw.one_in(2)) drawn.toml += "[ircom]\n";
    if (tams > 0) {
        drawn.script = drawn_requests(draw, kEnd);
        drawn.toml += fmt::format("[coordinator]\nuart = \"script:{}\"\n", kScript);
    }
    drawn.toml += fmt::format("[[speaker]]\nposition = [\"0 cm\", \"30 cm\"]\nlevel = {}\nwave = \"noise\"\n"
                              "duration = \"100 ms\"\nevery = \"300 ms\"\ntimes = 3\n",
                              1 + draw.below(400));
    drawn.toml += events(draw);
    return drawn;
}

}  // namespace puckloop::tests
