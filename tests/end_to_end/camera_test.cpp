// Cameras in a run: what programs see is the same in every placement, tools run unmodified.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// Two robots that see each other; one streams with `program`, the other one drives about.
std::string scenario(const std::string& program, const std::string& more = {}) {
    return fmt::format(R"([run]
seed = 7
duration = "3 s"
[arena]
size = ["1 m", "80 cm"]
[[cylinder]]
name = "can"
centre = ["20 cm", "15 cm"]
radius = "4 cm"
mass = "50 g"
[[floor_patch]]
centre = ["-20 cm", "0 cm"]
shape = "disc"
radius = "8 cm"
grey = 0.2
[[event]]
at = "1.2 s"
move = "can"
to = ["25 cm", "-20 cm"]
over = "500 ms"
[[robot]]
name = "eye"
position = ["0 cm", "0 cm"]
[robot.pic]
firmware = "{0}/firmware/epuck/epuck.hex"
[robot.linux]
program = [{1}]
start = "100 ms"
cameras = ["omni", "front"]
save_frames = 25
{2}
[[robot]]
name = "other"
position = ["-15 cm", "10 cm"]
heading = "-40 deg"
[robot.pic]
firmware = "{0}/firmware/epuck/epuck.hex"
[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "2.5"]
start = "100 ms"
)",
                       PUCKLOOP_SOURCE, program, more);
}

bool has(const char* tool) {
    return std::system(fmt::format("command -v {} >/dev/null 2>&1", tool).c_str()) == 0;
}

}  // namespace

TEST_CASE("frames are the same in every placement, with every number of threads") {
    const Workbench bench;
    const std::string file =
        bench.file("cameras.toml", scenario(fmt::format(R"("{}", "stream", "60")", PUCKLOOP_VIDEO_PROGRAM)));
    const std::vector<Words> ways{
        {}, {"--in-process"}, {"--in-process", "--threads", "2"}, {"--in-process", "--threads", "4"}};
    for (std::size_t i = 0; i < ways.size(); ++i) {
        Words words{file};
        words.insert(words.end(), ways[i].begin(), ways[i].end());
        const Ended ended = bench.run(fmt::format("o{}", i), words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    }
    const auto frames = bench.csv("o0", "eye.omni.csv");
    REQUIRE(frames.size() >= 60);
    // The other robot drives, so no two frames are alike.
    CHECK(frames[10].at("hash") != frames[40].at("hash"));
    CHECK(frames[0].at("format") == "YUYV");
    for (std::size_t i = 1; i < ways.size(); ++i) {
        const std::string name = fmt::format("o{}", i);
        check_same_run(bench, "o0", name);
        for (const char* of : {"eye.omni.csv", "eye.front.csv", "eye.linux.log"})
            CHECK(text_of(bench.out("o0") / of) == text_of(bench.out(name) / of));
        CHECK(bench.report("o0")["nodes"]["eye.linux"]["cameras"] ==
              bench.report(name)["nodes"]["eye.linux"]["cameras"]);
    }
    const auto cameras = bench.report("o0")["nodes"]["eye.linux"]["cameras"];
    CHECK(cameras[0]["device"] == "/dev/video1");
    CHECK(cameras[0]["frames"] == frames.size());
    CHECK(cameras[1]["frames"] == 0);
    // Every 25th frame is there as a picture.
    const std::string picture =
        text_of(bench.out("o0") / "eye.omni" / fmt::format("{:0>8}.ppm", frames[25].at("frame")));
    CHECK(picture.starts_with("P6\n352 288\n255\n"));
    CHECK(picture.size() == 15 + 352 * 288 * 3);
}

TEST_CASE("v4l2-ctl streams from both cameras") {
    if (!has("v4l2-ctl")) {
        WARN("v4l2-ctl is not here (Debian: v4l-utils): skipped");
        return;
    }
    const Workbench bench;
    for (const char* device : {"/dev/video0", "/dev/video1"}) {
        const std::string raw = (bench.folder() / "frames.yuv").string();
        const std::string file = bench.file(
            "tool.toml",
            scenario(fmt::format(
                R"("v4l2-ctl", "-d", "{}", "--set-fmt-video=width=320,height=240,pixelformat=YUYV", "--set-ctrl=gain=30", "--stream-mmap=3", "--stream-count=12", "--stream-to={}", "--verbose")",
                device, raw)));
        const Ended ended = bench.run("o", {file, "--in-process"});
        INFO(ended.err << text_of(bench.out("o") / "eye.linux.log"));
        REQUIRE(ended.status == 0);
        CHECK_THAT(text_of(bench.out("o") / "eye.linux.log"),
                   Contains("cap dqbuf: 2 seq:     11") && Contains("delta: 33.333 ms"));
        CHECK(std::filesystem::file_size(raw) == 12 * 320 * 240 * 2);
    }
    const std::string file = bench.file(
        "list.toml", scenario(R"("v4l2-ctl", "-d", "/dev/video1", "--all", "--list-formats-ext")"));
    REQUIRE(bench.run("l", {file, "--in-process"}).status == 0);
    CHECK_THAT(text_of(bench.out("l") / "eye.linux.log"),
               Contains("e-puck omnidirectional") && Contains("352x288") && Contains("30.000 fps"));
}

TEST_CASE("the driver passes v4l2-compliance, but for what it does not have") {
    if (!has("v4l2-compliance")) {
        WARN("v4l2-compliance is not here (Debian: v4l-utils): skipped");
        return;
    }
    const Workbench bench;
    const std::string file =
        bench.file("tool.toml", scenario(R"("v4l2-compliance", "-d", "/dev/video1", "-s", "4")"));
    bench.run("o", {file, "--in-process", "--duration", "30"});
    const std::string log = text_of(bench.out("o") / "eye.linux.log");
    INFO(log);
    for (const char* test :
         {"VIDIOC_QUERYCAP", "for unlimited opens", "VIDIOC_G/S_CTRL",
          "VIDIOC_ENUM_FMT/FRAMESIZES/FRAMEINTERVALS", "VIDIOC_S_FMT", "VIDIOC_REQBUFS/CREATE_BUFS/QUERYBUF",
          "read/write", "blocking wait", "MMAP (no poll)", "MMAP (select)", "MMAP (epoll)"})
        CHECK_THAT(log, Contains(fmt::format("test {}: OK", test)));
    // No events; cropping is there, which the tool does not want of a camera with several frame sizes.
    std::size_t failed = 0;
    for (std::size_t at = log.find(": FAIL"); at != std::string::npos; at = log.find(": FAIL", at + 1))
        ++failed;
    CHECK(failed <= 2);
    CHECK_THAT(log, Contains("Total for epuck-camera device /dev/video1"));
}

TEST_CASE("cameras that cannot be are refused with their place") {
    const Workbench bench;
    const auto refused = [&](const std::string& keys) {
        std::string text = scenario(R"("puckloop-control")", keys);
        if (const auto at = text.find("cameras = [\"omni\", \"front\"]\n"); keys.starts_with("cameras"))
            text.erase(at, text.find('\n', at) + 1 - at);
        const Ended ended = bench.run("r", {bench.file("bad.toml", text), "--in-process"});
        CHECK(ended.status == 2);
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
        return ended.err;
    };
    CHECK_THAT(refused("cameras = [\"rear\"]\n"),
               Contains("bad.toml:") && Contains("there is no camera 'rear'"));
    CHECK_THAT(refused("cameras = [\"omni\", \"omni\"]\n"), Contains("'omni' is there twice"));
    CHECK_THAT(refused("camera_devices = [\"/dev/video0\"]\n"), Contains("not one name for each"));
    CHECK_THAT(refused("camera_devices = [\"/dev/video0\", \"/dev/video0\"]\n"), Contains("is there twice"));
    CHECK_THAT(refused("camera_devices = [\"/dev/video0\", \"/dev/ttyS0\"]\n"),
               Contains("another device of the board"));
    CHECK_THAT(refused("camera_devices = [\"video0\", \"/dev/video1\"]\n"), Contains("not a device"));
    CHECK_THAT(refused("[robot.parameters]\n\"camera.eccentricity\" = 15\n"), Contains("eccentricity"));
}
