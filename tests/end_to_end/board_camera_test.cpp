// The main board's camera in a run: firmware takes pictures of the world, the same ones in every placement.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <fstream>
#include <sstream>

using namespace puckloop::tests;

namespace {

/// A robot takes three pictures with the project's own firmware; another one stands before it.
std::string scenario(const std::string& model) {
    return fmt::format(R"([run]
seed = 5
duration = "2.6 s"
[arena]
size = ["80 cm", "60 cm"]
floor_grey = 0.9
[[cylinder]]
name = "can"
centre = ["17 cm", "2 cm"]
radius = "1 cm"
mass = "50 g"
[[event]]
at = "1.2 s"
move = "can"
to = ["17 cm", "-2 cm"]
over = "200 ms"
[[robot]]
name = "eye"
position = ["0 cm", "0 cm"]
[robot.pic]
firmware = "camera.hex"
camera = "{}"
uart1 = "script:ask.txt"
[[robot]]
name = "other"
position = ["32 cm", "0 cm"]
heading = "150 deg"
[robot.pic]
firmware = "camera.hex"
)",
                       model);
}

std::vector<unsigned char> received(const Workbench& bench, const std::string& run) {
    std::ifstream in(bench.out(run) / "eye.uart1.received", std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    const std::string bytes = text.str();
    return {bytes.begin(), bytes.end()};
}

/// Share of full green, 0 to 1, of a pixel of a picture whose first byte is `at`.
double green(const std::vector<unsigned char>& bytes, std::size_t at, int x, int y) {
    const std::size_t pixel = at + 3 + 2 * static_cast<std::size_t>(40 * y + x);
    return ((bytes[pixel] << 3 & 0x38) | bytes[pixel + 1] >> 5) / 63.0;
}

}  // namespace

TEST_CASE("the main board's camera sees the world, the same in every placement and thread count") {
    const Workbench bench;
    bench.file("ask.txt", "0.6 49\n1.1 49\n1.9 49\n");
    const auto assembled = bench.puckloop(
        {"asm", PUCKLOOP_SOURCE "/firmware/camera/camera.s", "-o", (bench.folder() / "camera.hex").string()});
    REQUIRE(assembled.status == 0);
    const std::string file = bench.file("camera.toml", scenario("po3030k"));
    const std::vector<Words> ways{
        {}, {"--in-process"}, {"--in-process", "--threads", "2"}, {"--in-process", "--threads", "4"}};
    for (std::size_t i = 0; i < ways.size(); ++i) {
        Words words{file};
        words.insert(words.end(), ways[i].begin(), ways[i].end());
        const Ended ended = bench.run(fmt::format("o{}", i), words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        if (i == 0) continue;
        const std::string name = fmt::format("o{}", i);
        check_same_run(bench, "o0", name);
        CHECK(received(bench, "o0") == received(bench, name));
        CHECK(bench.report("o0")["nodes"]["eye.pic"]["camera"] ==
              bench.report(name)["nodes"]["eye.pic"]["camera"]);
    }
    CHECK(bench.report("o0")["nodes"]["eye.pic"]["camera"]["pictures"] == 3);
    CHECK(bench.csv("o0", "eye.pic.camera.csv").size() == 3);
    const std::vector<unsigned char> bytes = received(bench, "o0");
    constexpr std::size_t kPicture = 3 + 2 * 40 * 40;
    REQUIRE(bytes.size() == 6 + 3 * kPicture);
    CHECK(std::string(bytes.begin(), bytes.begin() + 6) == "3030\r\n");
    // The floor near the robot is bright, above the walls there is nothing; the can goes from left to right.
    constexpr std::size_t kFirst = 6, kLast = 6 + 2 * kPicture;
    CHECK(green(bytes, kFirst, 20, 38) > 0.2);  // at the default exposure white is 0.45
    CHECK(green(bytes, kFirst, 20, 38) > green(bytes, kFirst, 39, 0) + 0.1);
    double left = 0, right = 0, noise = 0;  // of what the can hid, and of what it did not
    for (int y = 10; y < 30; ++y)
        for (int x = 0; x < 10; ++x) {
            left += std::abs(green(bytes, kFirst, x, y) - green(bytes, kLast, x, y));
            right += std::abs(green(bytes, kFirst, 39 - x, y) - green(bytes, kLast, 39 - x, y));
            noise += std::abs(green(bytes, kFirst, 20, y) - green(bytes, kLast, 20, y));
        }
    CHECK(left > 3 * noise);
    CHECK(right > 3 * noise);
}

TEST_CASE("the camera's transfers are in the trace and its exports, and faults of the bus reach them") {
    const Workbench bench;
    bench.file("ask.txt", "0.3 49\n");
    REQUIRE(bench
                .puckloop({"asm", PUCKLOOP_SOURCE "/firmware/camera/camera.s", "-o",
                           (bench.folder() / "camera.hex").string()})
                .status == 0);
    const std::string file = bench.file("camera.toml", scenario("po3030k"));
    const auto greeting = [&](const std::string& name, const std::string& fault) {
        Words words{file, "--duration", "0.02", "--in-process", "--no-cache"};
        if (!fault.empty()) words.insert(words.end(), {"--fault", fault});
        const Ended ended = bench.run(name, words);
        INFO(fault << ": " << ended.err);
        CHECK(ended.status == 0);
        const std::vector<unsigned char> bytes = received(bench, name);
        return std::string(bytes.begin(), bytes.end());
    };
    CHECK(greeting("plain", "") == "3030\r\n");
    int starts = 0;
    std::vector<std::string> read;
    for (const Row& row : bench.csv("plain", "trace.csv")) {
        if (row.at("link") == "eye.i2c.pic" && row.at("detail") == "data") read.push_back(row.at("value"));
        starts += row.at("link") == "eye.i2c.camera" && row.at("detail") == "start" ? 1 : 0;
    }
    CHECK(read == std::vector<std::string>{"30", "30"});
    CHECK(starts > 4);  // the settings' writes besides
    CHECK(bench.report("plain")["nodes"]["eye.i2c"]["not_acknowledged"] == 0);
    const Ended decoded = bench.puckloop({"trace", "decode", bench.out("plain").string()});
    CHECK_THAT(decoded.out, Catch::Contains("0x6e camera read DEVICE_ID_L(1) = 30"));

    CHECK(greeting("flip", "flip link=eye.i2c address=0x6e phase=read bit=5 count=1") == "1030\r\n");
    CHECK(greeting("nack", "nack link=eye.i2c address=0x6e register=1 phase=address count=1") == "30FF\r\n");
    CHECK(greeting("sda", "sda link=eye.i2c address=0x6e phase=read time=70us count=1") == "0030\r\n");
    CHECK(greeting("stretch", "stretch link=eye.i2c address=0x6e phase=read time=3ms count=1") == "3030\r\n");
    CHECK(bench.report("stretch")["nodes"]["eye.i2c"]["stretched"] == 1);
}

TEST_CASE("a camera that cannot be is refused with its line") {
    const Workbench bench;
    const auto refused = [&](const std::string& text) {
        const Ended ended = bench.run("r", {bench.file("bad.toml", text)});
        CHECK(ended.status == 2);
        return ended.err;
    };
    CHECK_THAT(refused(scenario("po9999")), Catch::Contains("there is no camera 'po9999'"));
    CHECK_THAT(refused(scenario("po3030k") +
                       "camera = \"none\"\n[robot.linux]\nprogram = [\"x\"]\n"
                       "[[robot]]\nname = \"both\"\nposition = [\"-20 cm\", \"0 cm\"]\n"
                       "[robot.pic]\nfirmware = \"camera.hex\"\ncamera = \"po6030k\"\n"
                       "[robot.linux]\nprogram = [\"/bin/true\"]\ncameras = [\"front\"]\n"),
               Catch::Contains("both have cameras"));
}
