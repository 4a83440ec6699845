// Robots that hear each other in a run: what one plays through its codec, others read at their microphones.

#include "tests/end_to_end/kit/workbench.h"
#include "tests/kit/dspic_pieces.h"
#include "tests/kit/sound_player.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>

using namespace puckloop::tests;

namespace {

/// Two levels in turn, every seven samples.
std::string square(int level) {
    return sound_player(
        "        inc w5, w5\n        mov #7, w4\n        cp w5, w4\n        bra ltu, same\n        clr w5\n"
        "        neg w6, w6\nsame:   mov w6, w3\n",
        "        mov #" + std::to_string(level) + ", w6\n");
}

/// Sends largest minus smallest of 2000 conversions of AN2, AN3 and AN4 in turn: six bytes, low first.
const std::string kListener = kMain + R"(
        mov #7, w0
        mov w0, U1BRG
        bset U1MODE, #15
        bset U1STA, #10
        mov #0xFFE3, w0
        mov w0, ADPCFG
        mov #0x0014, w0
        mov w0, ADCON3
        mov #0x80E0, w0
        mov w0, ADCON1
again:  mov #2, w7
next:   mov w7, ADCHS
        mov #4095, w1
        clr w2
        mov #2000, w3
one:    bclr ADCON1, #0
        bset ADCON1, #1
wait:   btss ADCON1, #0
        bra wait
        mov ADCBUF0, w0
        cp w0, w1
        bra gtu, high
        mov w0, w1
high:   cp w0, w2
        bra ltu, low
        mov w0, w2
low:    dec w3, w3
        bra nz, one
        sub w2, w1, w0
        mov w0, U1TXREG
        lsr w0, #8, w0
        mov w0, U1TXREG
        inc w7, w7
        mov #5, w0
        cp w7, w0
        bra ltu, next
        bra again
)";

std::string image(const Workbench& bench, const std::string& name, const std::string& source) {
    const std::string hex = (bench.folder() / (name + ".hex")).string();
    const Ended ended = bench.puckloop({"asm", bench.file(name + ".s", source).string(), "-o", hex});
    REQUIRE(ended.status == 0);
    return hex;
}

std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The last volumes that a listener reported.
std::array<double, 3> volumes(const std::string& bytes) {
    REQUIRE(bytes.size() >= 12);
    const std::size_t first = bytes.size() / 6 * 6 - 6;
    std::array<double, 3> told{};
    for (std::size_t i = 0; i < 3; ++i)
        told[i] = static_cast<unsigned char>(bytes[first + 2 * i]) +
                  256.0 * static_cast<unsigned char>(bytes[first + 2 * i + 1]);
    return told;
}

}  // namespace

TEST_CASE("a robot's sound is read at others' microphones by the law of distance, in every placement",
          "[sound]") {
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed());
    const double near = 0.1 + 0.001 * static_cast<double>(random() % 60u),
                 far = 0.25 + 0.001 * static_cast<double>(random() % 150);
    const int level = 2 * static_cast<int>(4000 + random() % 6000u);
    CAPTURE(near, far, level);
    const std::string player = image(bench, "player", square(level));
    const std::string listener = image(bench, "listener", kListener);
    std::string text = "[run]\nduration = \"0.5 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
    const std::string nothing = bench.file("nothing.txt", "").string();
    const auto robot = [&](const std::string& name, double x, const std::string& firmware) {
        text += fmt::format("[[robot]]\nname = \"{}\"\nposition = [\"{} m\", \"0 m\"]\n[robot.pic]\nfirmware "
                            "= \"{}\"\nadc_noise = 0\nuart1 = \"script:{}\"\n",
                            name, x, firmware, nothing);
    };
    robot("player", 0.0, player);
    robot("near", -near, listener);
    robot("far", far, listener);
    const std::string file = bench.file("sound.toml", text).string();
    const Ended apart = bench.run("a", {file});
    REQUIRE(apart.status == 0);
    // Microphones 15 mm before and 26 mm beside the axle, one 30 mm behind it, 30 mm high; the speaker at 45
    // mm.
    const auto ways = [](double x) {
        const double front = std::hypot(x + 0.015, 0.026, 0.015), back = std::hypot(x - 0.03, 0.015);
        return std::array<double, 3>{front, front, back};
    };
    for (const auto& [name, x] : {std::pair{"near", -near}, std::pair{"far", far}}) {
        const auto told = volumes(content(bench.out("a") / fmt::format("{}.uart1.received", name)));
        for (std::size_t mic = 0; mic < 3; ++mic)
            CHECK(told[mic] == Approx(600.0 * level / 32768.0 * 0.1 / ways(x)[mic]).epsilon(0.03).margin(2));
    }
    REQUIRE(bench.run("b", {file, "--in-process", "--threads", "2"}).status == 0);
    CHECK(bench.report("a")["trace_sha256"] == bench.report("b")["trace_sha256"]);
}

namespace {

/// What the path of a robot with Demo.hex in the middle shows.
struct Heard {
    double x = 0.0, y = 0.0, heading = 0.0;  ///< whole turns count
};
constexpr double kFullTurn = 2 * 3.14159265358979;
Heard demo(const Workbench& bench, const std::filesystem::path& firmware, int selector,
           const std::string& sounding, double seconds) {
    const std::string text = fmt::format(
        "[run]\nduration = \"{} s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n{}[[robot]]\nname = \"demo\"\n"
        "position = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"{}\"\nselector = {}\n",
        seconds, sounding, firmware.string(), selector);
    REQUIRE(bench.run("demo", {bench.file("demo.toml", text).string(), "--in-process"}).status == 0);
    Heard last;
    for (const Row& row : bench.csv("demo", "trajectory.csv")) {
        if (row.at("robot") != "demo") continue;
        const double turned = std::remainder(std::stod(row.at("theta_rad")) - last.heading, kFullTurn);
        last = {std::stod(row.at("x_m")), std::stod(row.at("y_m")), last.heading + turned};
    }
    return last;
}
/// A robot at `x`, `y` that plays.
Heard demo(const Workbench& bench, const std::filesystem::path& firmware, int selector, double x, double y,
           const std::string& player, double seconds) {
    const std::string robot =
        fmt::format("[[robot]]\nname = \"player\"\nposition = [\"{} m\", \"{} m\"]\n[robot.pic]\n"
                    "firmware = \"{}\"\n",
                    x, y, image(bench, "player", player));
    return demo(bench, firmware, selector, robot, seconds);
}
std::string speaker(double x, double y, const std::string& keys) {
    return fmt::format("[[speaker]]\nposition = [\"{} m\", \"{} m\"]\n{}", x, y, keys);
}

}  // namespace

// Demo.hex, selector 9 (runfftlistener.c): below 900 Hz it turns left, up to 1800 Hz it goes ahead, above it
// turns right.
TEST_CASE("Demo's FFT follows the tone that another robot plays", "[sound][images]") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "Demo.hex");
    if (!firmware) return;
    const Workbench bench;
    const auto tone = [](double hertz) {  // a sine: the harmonics of a square wave would fold back
        std::string table = "        bra over\ntable:\n";
        constexpr int kWords = 32;
        for (int i = 0; i < kWords; ++i)
            table += fmt::format("        .pword {}\n",
                                 std::lround(20000 * std::sin(kFullTurn * i / kWords)) & 0xFFFE);
        return sound_player(
            fmt::format("        mov #{}, w4\n        add w5, w4, w5\n        lsr w5, #11, w2\n"
                        "        sl w2, #1, w2\n        mov #table, w3\n        add w2, w3, w2\n"
                        "        tblrdl [w2], w3\n",
                        std::lround(hertz * 65536 / 7200)),
            table + "over:\n");
    };
    std::mt19937 random(Catch::rngSeed());
    const double low = 500 + static_cast<double>(random() % 250u),
                 middle = 1050 + static_cast<double>(random() % 600u),
                 high = 2050 + static_cast<double>(random() % 900u);
    CAPTURE(low, middle, high);
    CHECK(demo(bench, *firmware, 9, -0.1, 0, tone(low), 3).heading > 0.15);
    CHECK(demo(bench, *firmware, 9, -0.1, 0, tone(high), 3).heading < -0.15);
    const Heard ahead = demo(bench, *firmware, 9, -0.1, 0, tone(middle), 3);
    CHECK(std::abs(ahead.heading) < 0.02);
    CHECK(ahead.x > 0.05);
}

// Selector 2 (runlocatesound.c): after a sound it turns to where the differences of arrival at its
// microphones say.
TEST_CASE("Demo turns to where another robot's burst of sound comes from", "[sound][images]") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "Demo.hex");
    if (!firmware) return;
    const Workbench bench;
    std::mt19937 random(Catch::rngSeed());
    const double bearing = static_cast<double>(random() % 628u) / 100.0;
    CAPTURE(bearing);
    // 60 samples of a loud 500 Hz at 3 s and every 3 s.
    const std::string burst = sound_player(
        "        inc w8, w8\n        mov #21600, w2\n        cp w8, w2\n        bra ltu, go\n        clr w8\n"
        "go:     mov #60, w2\n        cp w8, w2\n        bra ltu, play\n        clr w3\n        clr w5\n     "
        "   bra quiet\n"
        "play:   mov #4551, w4\n        add w5, w4, w5\n        mov #32000, w3\n        btsc w5, #15\n       "
        " neg w3, w3\nquiet:\n",
        "        mov #100, w8\n");
    const Heard turned =
        demo(bench, *firmware, 2, 0.08 * std::cos(bearing), 0.08 * std::sin(bearing), burst, 8);
    const double off = std::remainder(turned.heading - bearing, kFullTurn);
    CHECK(std::abs(off) < 0.35);
}

TEST_CASE("Demo's FFT follows the tone of a loudspeaker in the world", "[sound][images]") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "Demo.hex");
    if (!firmware) return;
    const Workbench bench;
    const auto heading = [&](int hertz) {
        return demo(bench, *firmware, 9,
                    speaker(-0.1, 0, fmt::format("level = 400\ntone = \"{} Hz\"\n", hertz)), 3)
            .heading;
    };
    CHECK(heading(650) > 0.15);
    CHECK(heading(2500) < -0.15);
}

// A clap is noise that travels. Its program distinguishes delays of whole samples, so directions to some 20
// degrees. Steady noise as loud as one would first try is below its threshold (docs/sound.md).
TEST_CASE("Demo turns to a clap of a loudspeaker, and hears no weak noise", "[sound][images]") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "Demo.hex");
    if (!firmware) return;
    const Workbench bench;
    const std::string clap = "on = \"3 s\"\nduration = \"30 ms\"\n";
    const auto turned = [&](double degrees, const std::string& keys) {
        const double bearing = degrees * kFullTurn / 360;
        const std::string table = speaker(0.1 * std::cos(bearing), 0.1 * std::sin(bearing), keys + clap);
        return std::remainder(demo(bench, *firmware, 2, table, 6).heading - bearing, kFullTurn);
    };
    for (const double degrees : {0.0, 45.0, 135.0, 225.0, 270.0}) {
        CAPTURE(degrees);
        CHECK(std::abs(turned(degrees, "level = 3000\nwave = \"noise\"\n")) < 0.4);
    }
    // It turns once by itself soon after its start, whatever sounds.
    CHECK(turned(0, "level = 300\n") == Approx(turned(0, "level = 1\n")).margin(1e-3));
}
