// The cameras as unmodified programs see them: a program that uses V4L2's calls in every way, and a scenery
// whose pictures say which frame they are.

#include "base/json.h"
#include "linuxboard/shim/devices/video_formats.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <linux/videodev2.h>

#include <filesystem>
#include <random>
#include <sstream>

using namespace puckloop;
using namespace puckloop::linuxboard;
using namespace puckloop::tests;
using cosim::kMillisecond;
using cosim::kSecond;

namespace {

/// Grey that depends on pixel, frame and the last change.
struct Stripes : Scenery {
    double last = 0.0;
    void change(std::uint16_t, double value) override { last = value; }
    static std::uint8_t grey(std::size_t pixel, std::uint64_t frame, double changed) {
        return static_cast<std::uint8_t>(pixel * 7 + frame * 13 + static_cast<std::uint64_t>(changed));
    }
    void render(std::size_t, const PictureSettings&, cosim::Time, std::uint64_t frame,
                std::span<std::uint8_t> rgb) override {
        for (std::size_t i = 0; i < rgb.size(); ++i)
            rgb[i] = grey(i / 3, frame, last);
    }
};

LinuxSpec camera_spec(const std::string& mode, int count = 5) {
    LinuxSpec spec = spec_for("video", {mode, std::to_string(count)});
    spec.cameras.push_back({"/dev/video1", "test camera", {}, {}, 1});
    return spec;
}

/// What the program sums up of a grey frame.
std::string sum_of(std::size_t pixels, std::uint64_t frame, double changed = 0.0) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < pixels; ++i)
        sum = sum * 31 + Stripes::grey(i, frame, changed);
    return fmt::format("sum {:x}", sum);
}

struct Result {
    std::string log;
    nlohmann::json report;
};

Result run_mode(const std::string& mode, int count, cosim::Time slice, double seconds = 20.0,
                double change_at = -1.0) {
    Bench bench(camera_spec(mode, count), slice, std::make_unique<Stripes>());
    if (change_at >= 0) bench.change(cosim::from_seconds(change_at), 3, 100.0);
    bench.run(cosim::from_seconds(seconds));
    Result result;
    REQUIRE(bench.node().stop());
    result.log = bench.log();
    result.report = nlohmann::json::parse(bench.node().finish());
    return result;
}

std::vector<std::string> lines_of(const std::string& text, const std::string& start) {
    std::vector<std::string> found;
    std::istringstream in(text);
    for (std::string line; std::getline(in, line);)
        if (line.starts_with(start)) found.push_back(line);
    return found;
}

}  // namespace

TEST_CASE("a camera answers V4L2's questions as a driver does") {
    const Result result = run_mode("conform", 1, kMillisecond);
    INFO(result.log);
    const std::string expected = "access 0 stat 0 chr 1\n"
                                 "querycap ok\n"
                                 "card test camera caps 1 1\n"
                                 "has YUYV: 640x480 352x288 320x240 176x144 160x120 1/30 1/15 1/10 1/5\n"
                                 "has UYVY: 640x480 352x288 320x240 176x144 160x120 1/30 1/15 1/10 1/5\n"
                                 "has RGBP: 640x480 352x288 320x240 176x144 160x120 1/30 1/15 1/10 1/5\n"
                                 "has GREY: 640x480 352x288 320x240 176x144 160x120 1/30 1/15 1/10 1/5\n"
                                 "end of formats EINVAL\n"
                                 "cropcap ok 640x480\n"
                                 "crop ok\n"
                                 "input ok 0\n"
                                 "control 980001 User Controls 0..0 0\n"
                                 "control 980900 Brightness -100..100 0\n"
                                 "control 980901 Contrast 0..200 100\n"
                                 "control 980902 Saturation 0..200 100\n"
                                 "control 980913 Gain 0..63 26\n"
                                 "control 980914 Horizontal Flip 0..1 0\n"
                                 "control 980915 Vertical Flip 0..1 0\n"
                                 "gain ok\n"
                                 "exposure EINVAL\n"
                                 "both ok 28 100\n"
                                 "try EINVAL at 1\n"
                                 "rate ok 1/10\n"
                                 "format ok 352x288 YUYV field 1 line 704 size 202752\n"
                                 "format ok 160x120 YUYV field 1 line 320 size 38400\n"
                                 "user pointers EINVAL\n"
                                 "nothing to stream EINVAL\n"
                                 "buffers ok\n"
                                 "granted 2\n"
                                 "no such buffer EINVAL\n"
                                 "take EINVAL\n"
                                 "not streaming EINVAL\n"
                                 "queue ok\n"
                                 "twice EINVAL\n"
                                 "map nowhere EINVAL\n"
                                 "map private EINVAL\n"
                                 "format EBUSY 320x240 YUYV field 4 line 0 size 0\n"
                                 "another file EBUSY\n"
                                 "querycap there ok\n"
                                 "export ENOTTY\n";
    CHECK(result.log.substr(0, expected.size()) == expected);
    const std::string rest = result.log.substr(std::min(result.log.size(), expected.size()));
    CHECK(rest.find("write EINVAL\nunknown ENOTTY\nunknown again ENOTTY\nof another kind ENOTTY\n") !=
          std::string::npos);
    const auto& refused = result.report["cameras"][0]["refused_ioctls"];
    CHECK(refused["VIDIOC_EXPBUF"] == 1);
    CHECK(refused["0xc00456c8"] == 2);
    const std::string warnings = result.report["warnings"].dump();
    CHECK(warnings.find("/dev/video1: ioctl 0xc00456c8") != std::string::npos);
}

TEST_CASE("frames come at the sensor's times, with their content, however grants are cut") {
    const Result result = run_mode("stream", 6, kMillisecond, 20.0, 0.2);
    INFO(result.log);
    CHECK(result.log.find("off ok\nunmap ok\nunmap ok\nfree ok\n") != std::string::npos);
    const auto frames = lines_of(result.log, "frame");
    REQUIRE(frames.size() == 6);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        INFO(frames[i]);
        unsigned sequence = 0, used = 0;
        double stamp = 0, now = 0;
        REQUIRE(std::sscanf(frames[i].c_str(), "frame %u used %u stamp %lf now %lf", &sequence, &used, &stamp,
                            &now) == 4);
        CHECK(sequence == i);
        CHECK(used == 352 * 288 * 2);
        // The sensor's frame 1 is the first that begins after the stream did; it is done when frame 2 begins.
        CHECK(stamp == Approx(60.0 + static_cast<double>(i + 2) / 30).margin(2e-6));
        CHECK(now == Approx(stamp).margin(1e-4));
    }
    // The change at 0.2 s, when frame 6 begins, is in that frame already.
    std::vector<std::uint8_t> rgb(352 * 288 * 3), yuyv(352 * 288 * 2);
    Stripes stripes;
    for (std::uint64_t frame = 1; frame <= 6; ++frame) {
        if (frame == 6) stripes.last = 100.0;
        stripes.render(0, {}, 0, frame, rgb);
        convert(*find_format(V4L2_PIX_FMT_YUYV), rgb, yuyv);
        std::uint64_t sum = 0;
        for (const std::uint8_t byte : yuyv)
            sum = sum * 31 + byte;
        CHECK(frames[frame - 1].ends_with(fmt::format("sum {:x}", sum)));
    }
    CHECK(result.report["cameras"][0]["lost"] == 0);
    std::mt19937 random(16);
    for (int i = 0; i < 4; ++i) {
        const cosim::Time slice = std::uniform_int_distribution<cosim::Time>(10, 90'000)(random) * 1'000'000;
        const Result other = run_mode("stream", 6, slice, 20.0, 0.2);
        CHECK(other.log == result.log);
        CHECK(other.report["cameras"] == result.report["cameras"]);
    }
}

TEST_CASE("a slow program loses the frames for which there was no buffer") {
    const Result result = run_mode("slow", 6, kMillisecond);
    INFO(result.log);
    std::vector<unsigned> sequences;
    for (const std::string& line : lines_of(result.log, "frame")) {
        unsigned sequence = 0;
        REQUIRE(std::sscanf(line.c_str(), "frame %u", &sequence) == 1);
        sequences.push_back(sequence);
        // The sensor's frame number is one higher: the stream began within frame 0.
        CHECK(line.ends_with(sum_of(176 * 144, sequence + 1)));
    }
    // Three buffers: 0, 1, 2 are filled at once; each that is given back takes the next frame to come.
    REQUIRE(sequences.size() == 6);
    CHECK(std::vector<unsigned>(sequences.begin(), sequences.begin() + 3) == std::vector<unsigned>{0, 1, 2});
    CHECK(sequences[3] == 3);  // its buffer came back in time
    CHECK(sequences[4] >= 16);
    CHECK(sequences[5] >= sequences[4] + 14);
    CHECK(result.report["cameras"][0]["lost"].get<int>() > 50);
}

TEST_CASE("select, poll and epoll wait for frames, in simulated time") {
    const Result result = run_mode("select", 3, kMillisecond);
    INFO(result.log);
    CHECK(lines_of(result.log, "expired").size() >= 3);
    CHECK(lines_of(result.log, "frame").size() == 4);
    CHECK(result.log.find("poll 1 8 after 0.000\n") != std::string::npos);
    CHECK(result.log.find("stopped 1 1\n") != std::string::npos);
    CHECK(result.log.find("epoll ok\nepoll 1 42\n") != std::string::npos);
    const Result waiting = run_mode("nonblocking", 1, kMillisecond);
    INFO(waiting.log);
    CHECK(lines_of(waiting.log, "take EAGAIN").size() == 1);
    CHECK(lines_of(waiting.log, "frame 0").size() == 1);
}

TEST_CASE("read() gives whole frames, in parts if need be") {
    const Result result = run_mode("read", 3, kMillisecond);
    INFO(result.log);
    const auto reads = lines_of(result.log, "read");
    REQUIRE(reads.size() == 3);
    for (std::size_t i = 0; i < reads.size(); ++i) {
        CHECK(reads[i].starts_with("read 1000 18200 sum"));
        // Every frame of the sensor: while one is read the next one is filled.
        CHECK(reads[i].find(sum_of(160 * 120, 1 + i)) != std::string::npos);
    }
    CHECK(result.log.find("buffers while reading EBUSY") != std::string::npos);
}

TEST_CASE("a stream ends with its file, is shared by fork, and never hangs a run") {
    const Result closed = run_mode("close", 1, kMillisecond);
    INFO(closed.log);
    CHECK(closed.log.find("still there 1") != std::string::npos);
    CHECK(lines_of(closed.log, "frame 0").size() == 2);

    const Result forked = run_mode("fork", 1, kMillisecond);
    INFO(forked.log);
    REQUIRE(lines_of(forked.log, "frame").size() == 3);
    CHECK(lines_of(forked.log, "child 7").size() == 1);
    for (unsigned i = 0; i < 3; ++i)
        CHECK(lines_of(forked.log, fmt::format("frame {} ", i)).size() == 1);

    Bench stuck(camera_spec("stuck"), kMillisecond, std::make_unique<Stripes>());
    stuck.run(2 * kSecond);
    CHECK_FALSE(stuck.node().stop());
    const auto report = nlohmann::json::parse(stuck.node().finish());
    CHECK(report["cameras"][0]["lost"].get<int>() > 50);
}

TEST_CASE("the end of a stream ends what waits for its frames, the highest priority changes the device") {
    const Result result = run_mode("threads", 1, kMillisecond);
    INFO(result.log);
    CHECK(lines_of(result.log, "waited EINVAL until").size() == 1);
    CHECK(result.log.find("joined after 0.200\n") != std::string::npos);
    CHECK(result.log.find("record ok\ngain elsewhere EBUSY\ngain here ok\ngain now ok\n") !=
          std::string::npos);
}

TEST_CASE("pixel formats carry colours as programs expect them") {
    std::mt19937 random(7);
    const auto* yuyv = find_format(V4L2_PIX_FMT_YUYV);
    const auto* uyvy = find_format(V4L2_PIX_FMT_UYVY);
    for (int i = 0; i < 500; ++i) {
        std::vector<std::uint8_t> rgb(6), a(4), b(4);
        for (int c = 0; c < 3; ++c)
            rgb[c] = rgb[c + 3] = static_cast<std::uint8_t>(random() & 255);
        convert(*yuyv, rgb, a);
        convert(*uyvy, rgb, b);
        CHECK(std::vector<int>{b[1], b[0], b[3], b[2]} == std::vector<int>{a[0], a[1], a[2], a[3]});
        // Back by the textbook's formulas.
        const double y = a[0], u = a[1] - 128.0, v = a[3] - 128.0;
        CHECK(y + 1.402 * v == Approx(rgb[0]).margin(2.0));
        CHECK(y - 0.344136 * u - 0.714136 * v == Approx(rgb[1]).margin(2.0));
        CHECK(y + 1.772 * u == Approx(rgb[2]).margin(2.0));
    }
    std::vector<std::uint8_t> red(2);
    convert(*find_format(V4L2_PIX_FMT_RGB565), std::vector<std::uint8_t>{255, 0, 0}, red);
    CHECK((red[0] | red[1] << 8) == 0xF800);
    CHECK(nearest_size(10'000, 10'000).width == 640);
    CHECK(nearest_size(0, 0).width == 160);
    // Reference values of FNV-1a over whole words.
    CHECK(frame_hash({}) == 0xcbf29ce484222325);
}
