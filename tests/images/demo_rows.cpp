// Demo: program/demo/main_c.c, a program for each position of the selector; 9 to 15 are one.

#include "tests/images/trial.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::images {

namespace {

Row row(const char* image, int selector, std::string says, std::function<std::string(Trial&)> see) {
    return {
        image, fmt::format("selector {}", selector), std::move(says), {.selector = selector}, std::move(see)};
}

std::string shocks(Trial& trial) {
    trial.set("acc_x", 4000);
    trial.set("acc_y", 4000);
    const double loud = trial.plays(0.5);
    expect(loud > 0.02, fmt::format("speaker at {}", loud));
    return "a shock: LEDs and a sound";
}

std::string drives(Trial& trial) {
    trial.run(3.5);
    trial.set("proximity0", 400);
    const auto there = trial.drives(1.0);
    expect(std::abs(there[0]) + std::abs(there[1]) > 50, fmt::format("drives {}, {}", there[0], there[1]));
    return "calibrates, then drives by its proximity sensors";
}

std::string looks(Trial& trial) {
    trial.run(1.0);
    const auto there = trial.drives(2.0);
    const bool found = trial.rig().get("led_body") > 0;
    expect(found || std::abs(there[0]) + std::abs(there[1]) > 50,
           fmt::format("drives {}, {}", there[0], there[1]));
    return found ? "takes pictures; a ball in the test pattern: body LED"
                 : "takes pictures and turns in search of a ball";
}

std::string listens(Trial& trial) {
    const auto there = trial.drives(1.0);
    expect(std::abs(there[0]) + std::abs(there[1]) > 50, fmt::format("drives {}, {}", there[0], there[1]));
    return "drives; tones steer it (sound.md)";
}

}  // namespace

std::vector<Row> demo_rows() {
    std::vector<Row> rows;
    constexpr const char *kDemo = "Demo.hex", *kOlder = "Demo-default.hex";
    rows.push_back(row(kDemo, 0, "shows the ground's direction", shows_the_ground));
    rows.push_back(row(kDemo, 1, "shock detection with sounds", shocks));
    rows.push_back(row(kDemo, 2, "locates a sound", locates_a_clap));
    rows.push_back(row(kDemo, 3, "wall following", drives));
    rows.push_back(row(kDemo, 4, "follows what is before it", drives));
    rows.push_back(row(kDemo, 5, "avoids obstacles", drives));
    rows.push_back(row(kDemo, 6, "follows all balls", looks));
    rows.push_back(row(kDemo, 7, "follows the red ball", looks));
    rows.push_back(row(kDemo, 8, "follows the green ball", looks));
    rows.push_back(row(kDemo, 9, "9 to 15: commanded by sound", listens));
    rows.push_back(row(kOlder, 0, "shows the ground's direction", shows_the_ground));
    rows.push_back(row(kOlder, 1, "shock detection with sounds", shocks));
    rows.push_back(row(kOlder, 2, "locates a sound", locates_a_clap));
    rows.push_back(row(kOlder, 3, "wall following", drives));
    rows.push_back(row(kOlder, 4, "follows what is before it", drives));
    rows.push_back(row(kOlder, 5, "avoids obstacles", drives));
    rows.push_back(row(kOlder, 6, "follows all balls", looks));
    rows.push_back(row(kOlder, 7, "follows the red ball", looks));
    rows.push_back(row(kOlder, 8, "follows the green ball", looks));
    rows.push_back(row(kOlder, 9, "9 to 15: commanded by sound", listens));
    return rows;
}

}  // namespace puckloop::images
