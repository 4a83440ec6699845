// The eight test sketches of the TAM's makers on the board: what each one shows on the console, at the LEDs,
// the barriers, the battery, the infra-red pins and the radio module. They need tam_test_*.elf in
// $PUCKLOOP_IMAGES, built from their public sources. Times are right within 1 %.
#include "base/random.h"
#include "tests/tam_board/booth.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::tam;
using namespace puckloop::tam::test;

namespace {

std::string sketch(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (!folder) return {};
    const std::string path = std::string(folder) + "/tam_test_" + name + ".elf";
    return std::filesystem::exists(path) ? path : std::string{};
}

#define NEEDS_SKETCH(name)                                                                                   \
    if (sketch(name).empty()) {                                                                              \
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with tam_test_" name ".elf");                  \
        return;                                                                                              \
    }

constexpr Time kSecond = cosim::kSecond;

/// Positions of `text` on the console.
std::vector<std::size_t> places(const Booth& booth, const std::string& text) {
    std::vector<std::size_t> found;
    for (std::size_t at = booth.console.find(text); at != std::string::npos;
         at = booth.console.find(text, at + 1))
        found.push_back(at);
    return found;
}

/// When the byte at `place` of the console was begun.
Time time_of(const Booth& booth, std::size_t place) {
    for (const auto& [unit, frame] : booth.rig.frames)
        if (unit == kConsoleUnit && place-- == 0) return frame.start;
    return cosim::kNever;
}

double level(const Booth& booth, const char* name) {
    const auto list = signals();
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].name == name) return booth.rig.board.signal(static_cast<SignalId>(i));
    FAIL("no signal " << name);
    return 0;
}

SignalId id_of(const char* name) {
    const auto list = signals();
    for (std::size_t i = 0; i < list.size(); ++i)
        if (list[i].name == name) return static_cast<SignalId>(i);
    FAIL("no signal " << name);
    return 0;
}

/// All twelve outputs of the RGB LEDs as SET_LEDS-like functions set them: red of the lower three is less.
void check_color(const Booth& booth, int red, int green, int blue) {
    const auto share = [](double value) { return std::floor(value) / 256; };
    for (const char* place : {"left", "middle", "right"})
        CHECK(level(booth, fmt::format("led_{}_red", place).c_str()) == share(red / 1.5));
    CHECK(level(booth, "led_top_red") == share(red));
    for (const char* place : {"left", "middle", "right", "top"}) {
        CHECK(level(booth, fmt::format("led_{}_green", place).c_str()) == share(green));
        CHECK(level(booth, fmt::format("led_{}_blue", place).c_str()) == share(blue));
    }
}

/// What the sketches print of a battery: ten bits of 3.3 V behind the divider, times 33, in mV.
int reported_mv(double volts) {
    return static_cast<int>(volts * 4.7 / (42.2 + 4.7) / 3.3 * 1024) * 33;
}

}  // namespace

TEST_CASE("sketch basics: a line every 400 ms, the infra-red LED comes on", "[slow]") {
    NEEDS_SKETCH("basics");
    Booth booth(sketch("basics"));
    booth.run_until(3 * kSecond);
    CHECK(booth.console.starts_with("IRIDIA TAM initialization OK\r\nIRIDIA TAM loop\r\n"));
    const auto lines = places(booth, "IRIDIA TAM loop\r\n");
    REQUIRE(lines.size() == 8);
    for (std::size_t i = 2; i < lines.size(); ++i)
        CHECK(ms(time_of(booth, lines[i]) - time_of(booth, lines[i - 1])) == Approx(400).epsilon(0.01));
    const auto light = booth.rig.of(kProximityEmit);
    REQUIRE(light.size() == 1);
    CHECK(light[0].value == 1.0);
    CHECK(ms(light[0].at) == Approx(201).epsilon(0.01));
}

TEST_CASE("sketch barriers: each barrier is measured dark and lit, its colour is shown", "[slow]") {
    NEEDS_SKETCH("barriers");
    Booth booth(sketch("barriers"));
    Board& board = booth.rig.board;
    booth.run_until(kSecond);
    check_color(booth, 0, 0, 20);  // both free
    const SignalId ir[] = {id_of("ir_led_left"), id_of("ir_led_right")};
    struct Case {
        double front, back;
        int red, green, blue;
        const char* text;
    };
    const Case cases[] = {{1, 0, 20, 0, 0, "[DEBUG] IR front interrupted!\n"},
                          {0, 1, 0, 20, 0, "[DEBUG] IR back interrupted!\n"},
                          {1, 1, 20, 20, 20, "[DEBUG] IR front and back interrupted!\n"},
                          {0, 0, 0, 0, 20, ""}};
    for (const Case& c : cases) {
        CAPTURE(c.text);
        board.set_signal(kBarrier, c.front);
        board.set_signal(kBarrier + 1, c.back);
        const std::size_t before = booth.console.size();
        booth.run_until(board.now() + 1100 * kMs);
        check_color(booth, c.red, c.green, c.blue);
        if (*c.text) CHECK(booth.console.find(c.text, before) != std::string::npos);
    }
    // Both infra-red LEDs, one behind the other on the bus, are on at 55/256 for a tenth of a second of five.
    for (const SignalId led : ir) {
        const auto changes = booth.rig.of(led);
        REQUIRE(changes.size() > 6);
        double on = 0, period = 0;
        for (std::size_t i = 2; i + 1 < changes.size(); i += 2) {
            CHECK(changes[i].value == 55.0 / 256);
            CHECK(changes[i + 1].value == 0.0);
            on = ms(changes[i + 1].at - changes[i].at);
            period = ms(changes[i].at - changes[i - 2].at);
            // Two delays of 100 ms; the report of two lines takes 25 ms of which the ring of 64 bytes hides
            // some.
            CHECK(on > 200);
            CHECK(on < 226);
            CHECK(period > 500);
            CHECK(period < 530);
        }
    }
    // printf reads the 32-bit cycle as 16 bits, so that its numbers are shifted: post, difference, threshold
    // are the dark value, the lit one and their difference. 0.2 V of 3.3 V are 62 of 1024.
    CHECK(booth.console.find("Front IR barrier: pre=0 post=62 difference=372 threshold=310\n\r") !=
          std::string::npos);
    CHECK(booth.console.find("Front IR barrier: pre=0 post=62 difference=62 threshold=0\n\r") !=
          std::string::npos);
    // Measured every five cycles: 0002, 0007, ...
    for (const char* cycle : {"[LIBA] 0002", "[LIBA] 0007", "[LIBA] 0012", "[LIBA] 0017"})
        CHECK(places(booth, cycle).size() == 2);
}

TEST_CASE("sketch leds: all LEDs blink, full on and off", "[slow]") {
    NEEDS_SKETCH("leds");
    Booth booth(sketch("leds"));
    booth.run_until(3 * kSecond);
    CHECK(booth.console.starts_with("IRIDIA TAM initialization OK...."));
    const auto network = booth.rig.of(id_of("network_led"));
    REQUIRE(network.size() > 20);
    // A delay of 100 ms, twelve brightness and two mode registers of 0.29 ms each.
    const double half = 100 + 14 * 0.29;
    for (std::size_t i = 1; i < network.size(); ++i) {
        CHECK(network[i].value == (i % 2 == 0 ? 1.0 : 0.0));
        CHECK(ms(network[i].at - network[i - 1].at) == Approx(half).epsilon(0.01));
    }
    int bright = 0, dark = 0;
    for (int i = 0; i < 8; ++i) {
        booth.run_until(booth.rig.of(id_of("ir_led_left")).back().at + 50 * kMs);
        const bool on = level(booth, "network_led") == 1.0;
        check_color(booth, on ? 255 : 0, on ? 255 : 0, on ? 255 : 0);
        CHECK(level(booth, "ir_led_left") == (on ? 1.0 : 0.0));
        CHECK(level(booth, "ir_led_right") == (on ? 1.0 : 0.0));
        ++(on ? bright : dark);
        booth.run_until(booth.rig.board.now() + 65 * kMs);
    }
    CHECK(bright > 2);
    CHECK(dark > 2);
}

TEST_CASE("sketch production: all LEDs at 55, the network LED blinks at 4.5 V to 5.5 V", "[slow]") {
    NEEDS_SKETCH("production");
    Booth booth(sketch("production"));
    Board& board = booth.rig.board;
    booth.run_until(kSecond);
    check_color(booth, 55, 55, 55);
    CHECK(level(booth, "ir_led_left") == 0.0);
    const auto lines = places(booth, "[DEBUG] Reading battery voltage: 3.795 V\n");
    REQUIRE(lines.size() == 2);
    // Ten cycles of a delay of 50 ms.
    CHECK(ms(time_of(booth, lines[1]) - time_of(booth, lines[0])) == Approx(503).epsilon(0.01));
    CHECK(places(booth, "..........[DEBUG]").size() == 1);
    CHECK(level(booth, "network_led") == 0.0);
    board.set_signal(kBattery, 4.7);  // read as 4.8 V
    const std::size_t before = booth.rig.of(id_of("network_led")).size();
    booth.run_until(3600 * kMs);
    const auto network = booth.rig.of(id_of("network_led"));
    REQUIRE(network.size() >= before + 4);
    for (std::size_t i = before + 1; i < network.size(); ++i)
        CHECK(ms(network[i].at - network[i - 1].at) == Approx(503).epsilon(0.01));
    CHECK(booth.console.find(fmt::format("voltage: 4.{:03} V", reported_mv(4.7) % 1000)) !=
          std::string::npos);
}

TEST_CASE("sketch voltage: every second the battery, ten empty readings switch off", "[slow]") {
    NEEDS_SKETCH("voltage");
    RandomStream random(3, "voltage");
    Booth booth(sketch("voltage"));
    Board& board = booth.rig.board;
    booth.run_until(500 * kMs);
    CHECK(booth.console.find("IRIDIA TAM initialization OK\n\n[DEBUG] Reading battery voltage: 3.795 V\n") ==
          0);
    for (int second = 1; second < 6; ++second) {
        const double volts = 2.95 + 1.5 * random.uniform();
        board.set_signal(kBattery, volts);
        booth.run_until(second * kSecond + 500 * kMs);
        const auto lines = places(booth, "[DEBUG] Reading battery voltage: ");
        REQUIRE(lines.size() == static_cast<std::size_t>(second) + 1);
        const int mv = reported_mv(volts);
        CAPTURE(volts);
        CHECK(booth.console.substr(lines.back() + 33, 5) == fmt::format("{}.{:03}", mv / 1000, mv % 1000));
        CHECK(ms(time_of(booth, lines.back()) - time_of(booth, lines[lines.size() - 2])) ==
              Approx(1002).epsilon(0.01));
        CHECK((booth.console.find("Battery low!", lines.back()) != std::string::npos) ==
              (mv > 2700 && mv <= 3000));
    }
    board.set_signal(kBattery, 2.55);
    const std::size_t begun = booth.console.size();
    const Time empty = board.now();
    booth.run_until(empty + 13 * kSecond);
    CHECK_FALSE(board.powered());
    const auto clear = booth.rig.of(kPowerClear);
    REQUIRE_FALSE(clear.empty());
    const std::size_t last = booth.console.find("Battery empty, shutting down!", begun);
    REQUIRE(last != std::string::npos);
    CHECK(places(booth, "Battery empty!\n").size() == 10);
    CHECK(ms(clear[0].at - time_of(booth, last)) == Approx(1500).epsilon(0.01));
}

TEST_CASE("sketch proximity: pulses of a second are measured, then the LED is lit for one", "[slow]") {
    NEEDS_SKETCH("proximity");
    Booth booth(sketch("proximity"));
    Board& board = booth.rig.board;
    booth.run_until(2500 * kMs);
    CHECK(booth.console.find("Sampling...done, sending now.\nNo pulses\n") != std::string::npos);
    const auto light = booth.rig.of(kProximityEmit);
    REQUIRE(light.size() == 1);
    CHECK(ms(light[0].at) == Approx(2017).epsilon(0.01));
    booth.run_until(3500 * kMs);
    // Sampling since 3.02 s: 200 half periods of each length; the first 64 are kept, a constant 496 ns a
    // tick.
    RandomStream random(7, "proximity");
    for (int round = 0; round < 2; ++round) {
        const Time half = (100 + static_cast<Time>(random.below(800))) * cosim::kMicrosecond;
        const Time begin = board.now();
        for (int edge = 1; edge <= 200; ++edge) {
            booth.run_until(begin + edge * half);
            board.set_signal(kProximitySense, edge % 2 == 1 ? 1.0 : 0.0);
        }
        const std::size_t before = booth.console.size();
        booth.run_until((4500 + 2000 * round) * kMs);
        const std::size_t at = booth.console.find("  avg: ", before);
        REQUIRE(at != std::string::npos);
        const double expected = static_cast<double>(half) / static_cast<double>(cosim::kMicrosecond) * 0.992;
        const auto number = [&](const char* name) {
            const std::size_t place = booth.console.find(name, before);
            REQUIRE(place != std::string::npos);
            return std::stod(booth.console.substr(place + 7));
        };
        CAPTURE(round, half);
        CHECK(number("  min: ") == Approx(expected).margin(0.01 * expected + 3));
        CHECK(number("  avg: ") > 0.9 * expected);
        booth.run_until((5500 + 2000 * round) * kMs);
    }
}

TEST_CASE("sketch ircom: words are read from the comparator and printed", "[slow]") {
    NEEDS_SKETCH("ircom");
    Booth booth(sketch("ircom"));
    booth.run_until(100 * kMs);
    CHECK(booth.console.starts_with("pulses are sampled while LED is lit\r\n496 microseconds per tick\r\n"));
    CHECK(booth.console.ends_with("Tick precision: 496 (microseconds)\n"));
    CHECK(booth.rig.board.signal(kProximityEmit) == 1.0);
    RandomStream random(12, "ircom");
    for (int i = 0; i < 256; ++i) {
        const auto word = static_cast<std::uint8_t>(i);
        const std::size_t before = booth.console.size();
        booth.hear(word, booth.rig.board.now() + 30 * kMs, 0.97 + 0.06 * random.uniform());
        booth.run_until(booth.rig.board.now() + 60 * kMs);
        CAPTURE(static_cast<int>(word));
        CHECK(booth.console.substr(before) == fmt::format("RECEIVE SUCCESSFUL: {}\n", word));
    }
    // A word with one symbol missing is reported as an error, or not at all, but never as a word.
    const std::size_t before = booth.console.size();
    const std::vector<Time> edges = ircom_edges(0x5A);
    bool up = false;
    const Time begin = booth.rig.board.now();
    for (std::size_t i = 0; i < edges.size(); ++i) {
        booth.run_until(begin + edges[i]);
        if (i >= 40 && i < 50) continue;
        booth.rig.board.set_signal(kProximitySense, up ? 0.0 : 1.0);
        up = !up;
    }
    booth.run_until(booth.rig.board.now() + 100 * kMs);
    CHECK(booth.console.find("RECEIVE SUCCESSFUL", before) == std::string::npos);
}

TEST_CASE("sketch xbee: the module is set up, its parameters and the signal strength are printed", "[slow]") {
    NEEDS_SKETCH("xbee");
    Booth booth(sketch("xbee"));
    RandomStream random(8, "xbee");
    const auto channel = static_cast<std::uint8_t>(0x0B + random.below(16));
    const auto strength = static_cast<std::uint8_t>(20 + random.below(70));
    booth.values = {{"ID", {0x01, 0xB5}},
                    {"SH", {0x00, 0x13, 0xA2, 0x00}},
                    {"SL", {0x40, 0x8A, 0x31, 0x07}},
                    {"CH", {channel}},
                    {"DB", {strength}}};
    booth.run_until(4 * kSecond);
    const std::vector<std::string> commands = [&] {
        std::vector<std::string> list;
        for (const auto& [at, message] : booth.sent)
            if (const auto* command = std::get_if<XBeeAt>(&message))
                list.emplace_back(command->command.begin(), command->command.end());
        return list;
    }();
    CHECK(commands == std::vector<std::string>{"NT", "ID", "DN", "NI", "SH", "SL", "CH", "DB"});
    const XBeeBytes begins{0x7E, 0x00, 0x05, 0x08, 0x01, 0x4E, 0x54, 0x82, 0xD2, 0x7E,
                           0x00, 0x06, 0x08, 0x01, 0x49, 0x44, 0x01, 0xB5, 0xB3};
    REQUIRE(booth.sent_bytes.size() > begins.size());
    CHECK(std::equal(begins.begin(), begins.end(), booth.sent_bytes.begin()));
    for (const std::string& line :
         {std::string("Firmware version: xbee test\n"), std::string("  TAM network ID: TAM01\n"),
          std::string("  High address  : 0x0013a200\n"), std::string("  Low address   : 0x408a3107\n"),
          std::string("  PAN ID        : 0x01b5\n"), fmt::format("  Channel       : 0x{:02x}\n", channel),
          std::string("  Coordinator h.: 0x0013a200\n"), std::string("  Coordinator l.: 0x408a3107\n"),
          std::string("IRIDIA TAM initialization: OK\r\n"), fmt::format("Signal stength: {}\n", strength)}) {
        CAPTURE(line);
        CHECK(booth.console.find(line) != std::string::npos);
    }
    const auto reset = booth.rig.of(kXBeeReset);
    REQUIRE(reset.size() == 2);
    CHECK(ms(reset[1].at - reset[0].at) == Approx(120).epsilon(0.01));
    // The strength every 10 s.
    booth.run_until(14 * kSecond);
    const auto lines = places(booth, "Signal stength: ");
    REQUIRE(lines.size() == 2);
    CHECK(ms(time_of(booth, lines[1]) - time_of(booth, lines[0])) == Approx(10'000).epsilon(0.01));
}
