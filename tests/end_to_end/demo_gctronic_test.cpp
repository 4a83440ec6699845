// demoGCtronic in a scene: it turns to the lightest thing its camera sees, and to each clap it hears. Images
// come from PUCKLOOP_IMAGES; without them those cases say so and pass.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>
#include <random>

using namespace puckloop::tests;

namespace {

constexpr double kFullTurn = 2 * 3.14159265358979;

/// A robot in the middle of an arena without light but the room's.
std::string scene(const std::string& image, int selector, double seconds, const std::string& more) {
    return fmt::format(
        "[run]\nduration = \"{} s\"\n[arena]\nsize = [\"1.2 m\", \"1.2 m\"]\n{}[[robot]]\nposition = "
        "[\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"{}\"\nselector = {}\ncamera = \"po3030k\"\n"
        "camera_turned = true\n",
        seconds, more, image, selector);
}

/// The robot's heading at a time, whole turns left out.
double heading(const std::vector<Row>& path, double time) {
    double heading = 0.0;
    for (const Row& row : path)
        if (std::stod(row.at("t_s")) <= time) heading = std::stod(row.at("theta_rad"));
    return heading;
}

}  // namespace

// runshow.c, run_CameraTurn(): a column of 60 pixels, the speed of turning proportional to how far the
// lightest is from the middle. A pixel is 1 degree wide, the motors' step 0.3 degrees.
TEST_CASE("demoGCtronic turns its camera to a lamp and follows it", "[images]") {
    const auto image = outside("PUCKLOOP_IMAGES", "demoGCtronic.X.production.hex");
    if (!image) {
        WARN("no image of demoGCtronic");
        return;
    }
    std::mt19937 random(Catch::rngSeed());
    std::uniform_real_distribution<double> within(0.12, 0.32);  // the camera sees 0.45 rad to either side
    const double side = random() % 2 ? 1.0 : -1.0;
    const double first = side * within(random), second = first - side * within(random);
    CAPTURE(first, second);
    const auto place = [](double bearing) {
        return fmt::format("[\"{} m\", \"{} m\"]", 0.42 * std::cos(bearing), 0.42 * std::sin(bearing));
    };
    const Workbench bench;
    const std::string file =
        bench
            .file(
                "lamp.toml",
                scene(
                    image->string(), 6, 10,
                    "[[lamp]]\nname = \"sun\"\ncentre = " + place(first) +
                        "\nheight = \"5 cm\"\nintensity = 1\n[[event]]\nat = \"5 s\"\nmove = \"sun\"\nto = " +
                        place(second) + "\nover = \"2 s\"\n"))
            .string();
    REQUIRE(bench.run("lamp", {file, "--in-process"}).status == 0);
    const std::vector<Row> path = bench.csv("lamp", "trajectory.csv");
    CHECK(heading(path, 0.9) == 0.0);
    CHECK(heading(path, 4.9) == Approx(first).margin(0.03));
    CHECK(heading(path, 10) == Approx(second).margin(0.03));
}

// The build of revision 117 has runlocatesound.c at position 1: after each sound an LED for 0.5 s and a turn,
// then it listens again.
TEST_CASE("demoGCtronic turns once for each clap in the room", "[images]") {
    const auto image = outside("PUCKLOOP_IMAGES", "demoGCtronic-rev117+bootloader.hex");
    if (!image) {
        WARN("no image of demoGCtronic, revision 117");
        return;
    }
    std::mt19937 random(Catch::rngSeed());
    std::uniform_real_distribution<double> angle(0, kFullTurn), wait(3.6, 4.4);
    std::vector<double> claps;
    const std::size_t count = 2 + random() % 3;
    std::string speakers;
    double at = 4.0;
    for (; claps.size() < count; at += wait(random)) {
        claps.push_back(at);
        const double bearing = angle(random);
        speakers += fmt::format(
            "[[speaker]]\nposition = [\"{} m\", \"{} m\"]\nlevel = 1200\non = \"{} s\"\noff = \"{} s\"\n",
            0.18 * std::cos(bearing), 0.18 * std::sin(bearing), at, at + 0.03);
    }
    CAPTURE(speakers);
    const Workbench bench;
    const std::string file = bench.file("clap.toml", scene(image->string(), 1, at, speakers)).string();
    REQUIRE(bench.run("clap", {file, "--in-process"}).status == 0);
    // LEDs that went on after it had begun to listen.
    std::vector<double> shown;
    for (const Row& row : bench.csv("clap", "trace.csv")) {
        const double time = std::stod(row.at("time_s"));
        if (time > 3.9 && row.at("detail").starts_with("led") && row.at("value") == "1")
            shown.push_back(time);
    }
    REQUIRE(shown.size() == count);
    for (std::size_t i = 0; i < count; ++i) {
        CHECK(shown[i] > claps[i]);
        CHECK(shown[i] < claps[i] + 0.6);
    }
}
