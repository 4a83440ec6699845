// Robots that hear each other in a run: what one plays through its codec, others read at their microphones.

#include "tests/end_to_end/workbench.h"

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

const std::string kStart = R"(
        goto main
VECTOR
        .org 0x0100
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
)";

/// Sets the codec up (PLL, speaker on) and plays two levels in turn, every HALF samples.
const std::string kPlayer = R"(
        bclr LATF, #0
        bclr TRISF, #0
        repeat #400
        nop
        bset LATF, #0
        mov #0x04EF, w0
        mov w0, DCICON2
        mov #3, w0
        mov w0, DCICON3
        mov #1, w0
        mov w0, TSCON
        mov w0, RSCON
        mov #0x0413, w1
        rcall prime
        bset DCICON1, #15
        mov #0x0118, w1
        rcall set
        mov #0x075F, w1
        rcall set
        mov #0, w1
        rcall set
last:   btss DCISTAT, #0
        bra last
        bclr DCICON1, #15
        mov #0x01EF, w0
        mov w0, DCICON2
        mov #LEVEL, w6
        clr w5
        bclr IFS2, #9
        bset IEC2, #9
        bset DCICON1, #15
sleep:  pwrsav #1
        bra sleep
set:    btss DCISTAT, #0
        bra set
prime:  mov #0x7FFF, w0
        cp0 w1
        bra nz, wanted
        clr w0
wanted: mov w0, TXBUF0
        mov w1, TXBUF1
        return
isr:    bclr IFS2, #9
        inc w5, w5
        mov #HALF, w4
        cp w5, w4
        bra ltu, same
        clr w5
        neg w6, w6
same:   mov w6, TXBUF0
        mov RXBUF0, w2
        retfie
)";

/// Sends largest minus smallest of 2000 conversions of AN2, AN3 and AN4 in turn: six bytes, low first.
const std::string kListener = R"(
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

std::string with(std::string text, const std::string& word, const std::string& value) {
    text.replace(text.find(word), word.size(), value);
    return text;
}

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

/// The last volumes that a listener told.
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
    std::mt19937 random(std::random_device{}());
    const double near = 0.1 + 0.001 * static_cast<double>(random() % 60u),
                 far = 0.25 + 0.001 * static_cast<double>(random() % 150);
    const int level = 2 * static_cast<int>(4000 + random() % 6000u);
    CAPTURE(near, far, level);
    const std::string player =
        image(bench, "player",
              with(with(with(kStart, "VECTOR", "        .org 0x0066\n        .pword isr") + kPlayer, "LEVEL",
                        std::to_string(level)),
                   "HALF", "7"));
    const std::string listener = image(bench, "listener", with(kStart, "VECTOR", "") + kListener);
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
