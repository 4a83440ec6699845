// Scenarios of robots: their boards, buses, light and programs.

#include "tests/time_bounds/scenarios.h"

#include <fmt/format.h>

#include <array>

namespace puckloop::tests {

std::string drawn_head(Draw& draw, double width, double depth) {
    return fmt::format("[run]\nseed = {}\n[arena]\nsize = [\"{} m\", \"{} m\"]\n", 1 + draw.below(1'000'000),
                       width, depth);
}

std::string drawn_robot(Draw& draw, int place, const std::string& firmware, const std::string& keys) {
    return fmt::format("[[robot]]\nname = \"r{}\"\nposition = [\"{} cm\", \"{:.2f} cm\"]\nheading = \"{} "
                       "deg\"\n[robot.pic]\nfirmware = \"{}/firmware/{}\"\ncrystal_error = \"{} ppm\"\n{}",
                       place, -35 + 25 * place, draw.uniform(-20, 20), draw.below(360), PUCKLOOP_SOURCE,
                       firmware, static_cast<int>(draw.below(100)) - 50, keys);
}

DrawnScenario draw_rab(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 1.2;
    drawn.toml = drawn_head(draw, 1, 0.8);
    for (int i = 0; i < 2; ++i) {
        drawn.toml += drawn_robot(draw, i, "epuck/epuck.hex");
        drawn.toml +=
            fmt::format("[robot.rab]\nfirmware = \"{}/firmware/rab/rab.hex\"\ncrystal_error = \"{} ppm\"\n",
                        PUCKLOOP_SOURCE, static_cast<int>(draw.below(60)) - 30);
        drawn.toml += fmt::format("[robot.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", "
                                  "\"follow\", \"--rab-id\", \"{}\", \"--duration\", \"30\"]\nstart = {}\n",
                                  i + 1, draw.time(0.1, 0.3));
        if (draw.one_in(2)) drawn.toml += fmt::format("restart = [{}]\n", draw.time(0.4, drawn.seconds));
    }
    return drawn;
}

DrawnScenario draw_bluetooth(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 5;
    drawn.toml = drawn_head(draw, 1, 0.8);
    for (int i = 0; i < 2; ++i)
        drawn.toml +=
            drawn_robot(draw, i, "bluetooth/talk.hex",
                        fmt::format("selector = {}\nuart2 = \"script:/dev/null\"\n[robot.pic.bluetooth]\n"
                                    "boot = \"{:.3f} s\"\n",
                                    1 - i, draw.uniform(0.01, 0.6)));
    if (draw.one_in(2)) {
        for (int i = 0; i < 20; ++i)
            drawn.script += fmt::format("{:.6f} 41 54 0d\n", 0.25 * i + draw.uniform(0, 0.2));
        drawn.toml += fmt::format("computer = \"script:{}\"\nconnect = {}\n", kScript, draw.time(0, 2));
    }
    drawn.toml += fmt::format("[bluetooth]\ndiscovery = {}\nlink_time = [\"{:.3f} s\", \"0.2 s\"]\n",
                              draw.time(0.1, 1), draw.uniform(0.3, 1.5));
    return drawn;
}

DrawnScenario draw_can(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 0.3;
    drawn.toml = drawn_head(draw, 1, 0.8);
    for (int i = 0; i < 3; ++i)
        drawn.toml += drawn_robot(draw, i, "can/can.hex", fmt::format("selector = {}\n", i));
    drawn.toml += "[[can_bus]]\ncontrollers = [\"r0.pic.can1\", \"r1.pic.can1\", \"r2.pic.can1\"]\n";
    return drawn;
}

DrawnScenario draw_ircom(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 2.5;
    drawn.toml = drawn_head(draw, 2, 1.2) + drawn_tam(draw, 0, drawn.seconds);
    for (int i = 0; i < 2; ++i) {
        drawn.toml += drawn_robot(draw, i, "epuck/epuck_ircom.hex");
        drawn.toml +=
            fmt::format("[robot.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", \"wander\", "
                        "\"--ircom-send\", \"0xa{}\", \"--ircom-every\", \"0.2\"]\nstart = {}\n",
                        i, draw.time(0.1, 0.8));
    }
    return drawn;
}

DrawnScenario draw_camera(Draw& draw) {
    DrawnScenario drawn;
    drawn.seconds = 1.5;
    drawn.toml = drawn_head(draw, 1, 0.8);
    drawn.script = fmt::format("{:.6f} 70\n", draw.uniform(0.2, 0.8));
    drawn.toml += drawn_robot(draw, 0, "camera/camera.hex",
                              fmt::format("camera = \"{}\"\nuart1 = \"script:{}\"\n",
                                          draw.of(std::array{"po3030k", "po6030k", "po8030d"}), kScript));
    drawn.toml += drawn_robot(draw, 1, "epuck/epuck_ircom.hex");
    drawn.toml += fmt::format("[robot.linux]\nprogram = [\"puckloop-control\", \"--behaviour\", \"seek\"]\n"
                              "cameras = [\"omni\", \"front\"]\nstart = {}\n",
                              draw.time(0.1, 0.5));
    return drawn;
}

}  // namespace puckloop::tests
