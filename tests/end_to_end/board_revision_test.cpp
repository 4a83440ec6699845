// A robot with board revision 1.3 in a run: the LSM330 on its bus feels what the world does, in the trace and
// under faults. The image is the library's demoGCtronic, whose letters g, A and b (selector 3) ask for turn
// rates, accelerations and the battery.

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <sstream>

using namespace puckloop::tests;

namespace {

std::string hex(const std::string& text) {
    std::string bytes;
    for (const unsigned char c : text)
        bytes += fmt::format(" {:02x}", c);
    return bytes + "\n";
}

std::string received(const Workbench& bench, const std::string& run) {
    std::ifstream file(bench.out(run) / "eye.uart1.received", std::ios::binary);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

}  // namespace

TEST_CASE("the LSM330 of board revision 1.3 feels the world in a run, in its trace and under faults") {
    const auto image = outside("PUCKLOOP_IMAGES", "demoGCtronic-rev117+bootloader.hex");
    if (!image) {
        WARN("skipped: no demoGCtronic in PUCKLOOP_IMAGES");
        return;
    }
    const Workbench bench;
    std::string script = "4.0" + hex("D,-150,150\r");
    for (const char* const time : {"4.5", "4.6", "4.7"})
        script += time + hex("g\r");
    script += "4.8" + hex("A\r") + "4.9" + hex("A\r") + "5.0" + hex("b\r");
    const std::string text = fmt::format(
        "[run]\nduration = \"5.2 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n[[robot]]\nname = \"eye\"\n"
        "position = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"{}\"\nboard = \"1.3\"\nselector = "
        "3\nuart1 = \"script:{}\"\n",
        image->string(), bench.file("ask.txt", script).string());
    const std::string file = bench.file("turn.toml", text).string();
    REQUIRE(bench.run("a", {file}).status == 0);
    const std::string heard = received(bench, "a");
    INFO(heard);
    // 150 steps/s each way: 2 x 19.3 mm/s over 53 mm are 41.8 deg/s, 8.75 mdeg/s a digit.
    int asked = 0;
    for (std::size_t at = heard.find("g,"); at != std::string::npos; at = heard.find("g,", at + 1)) {
        std::array<int, 3> rate{};
        REQUIRE(std::sscanf(heard.c_str() + at, "g,%d,%d,%d", &rate[0], &rate[1], &rate[2]) == 3);
        CHECK(rate[2] * 8.75e-3 == Approx(41.8).margin(4));
        ++asked;
    }
    CHECK(asked == 3);
    std::array<int, 3> acceleration{};
    REQUIRE(std::sscanf(heard.c_str() + heard.rfind("a,"), "a,%d,%d,%d", &acceleration[0], &acceleration[1],
                        &acceleration[2]) == 3);
    CHECK(acceleration[2] == Approx(2048 + 768).margin(40));
    CHECK(std::abs(acceleration[0] - 2048) < 80);
    int raw = 0, percent = 0;
    REQUIRE(std::sscanf(heard.c_str() + heard.find("b,"), "b,%d (%d%%)", &raw, &percent) == 2);
    CHECK((percent > 20 && percent <= 101));
    bool on_bus = false;
    for (const auto& row : bench.csv("a", "trace.csv"))
        on_bus = on_bus || row.at("link") == "eye.i2c.pic";
    CHECK(on_bus);
    const nlohmann::json devices = bench.report("a")["nodes"]["eye.i2c"];
    INFO(devices.dump());
    CHECK(devices.dump().find("lsm330_gyroscope") != std::string::npos);

    REQUIRE(bench.run("b", {file, "--in-process", "--threads", "2"}).status == 0);
    CHECK(bench.report("a")["trace_sha256"] == bench.report("b")["trace_sha256"]);

    // An accelerometer that never answers is none: the image takes the board for an old one.
    REQUIRE(bench.run("c", {file, "--in-process", "--fault", "nack link=eye.i2c address=0x1e"}).status == 0);
    const std::string deaf = received(bench, "c");
    INFO(deaf);
    CHECK(deaf.find("g,0,0,0\r\n") != std::string::npos);
    CHECK(deaf.find("b,1\r\n") != std::string::npos);
}
