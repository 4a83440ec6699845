// The TAM's real firmware on the board, with a radio module that answers promptly: TAM fact sheet, sections 4
// to 8. Needs tam_firmware.elf in $PUCKLOOP_IMAGES, built from its public sources.
#include "tests/tam_board/booth.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <filesystem>

using namespace puckloop;
using namespace puckloop::tam;
using namespace puckloop::tam::test;

namespace {

std::string image_path() {
    const char* folder = std::getenv("PUCKLOOP_IMAGES");
    if (!folder) return {};
    const std::string path = std::string(folder) + "/tam_firmware.elf";
    return std::filesystem::exists(path) ? path : std::string{};
}

#define NEEDS_IMAGE()                                                                                        \
    if (image_path().empty()) {                                                                              \
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with tam_firmware.elf");                       \
        return;                                                                                              \
    }

}  // namespace

TEST_CASE("without a radio module the TAM waits for ever and sends nothing", "[slow]") {
    NEEDS_IMAGE();
    Booth booth(image_path());
    booth.answers = false;
    booth.run_until(5 * cosim::kSecond);
    CHECK(booth.sent_bytes.empty());
    CHECK(booth.console.find("Starting IRIDIA TAM") != std::string::npos);
    CHECK(booth.console.find("Waiting for XBee") != std::string::npos);
    const auto reset = booth.rig.of(kXBeeReset);
    REQUIRE(reset.size() == 2);
    CHECK(ms(reset[1].at - reset[0].at) == Approx(120).epsilon(0.01));
}

TEST_CASE("the TAM starts up, reports and obeys as in its fact sheet", "[slow]") {
    NEEDS_IMAGE();
    Booth booth(image_path());
    booth.run_until(11 * cosim::kSecond);
    // Section 6: what is sent before the first report, byte for byte.
    const XBeeBytes start_up{0x7E, 0x00, 0x05, 0x08, 0x01, 0x4E, 0x54, 0x82, 0xD2,        // NT
                             0x7E, 0x00, 0x06, 0x08, 0x01, 0x49, 0x44, 0x01, 0xB5, 0xB3,  // ID
                             0x7E, 0x00, 0x09, 0x08, 0x01, 0x44, 0x4E, 0x43, 0x4F, 0x4F,
                             0x52, 0x44, 0xED,                                 // DN COORD
                             0x7E, 0x00, 0x04, 0x08, 0x01, 0x4E, 0x49, 0x5F,   // NI
                             0x7E, 0x00, 0x04, 0x08, 0x01, 0x53, 0x48, 0x5B,   // SH
                             0x7E, 0x00, 0x04, 0x08, 0x01, 0x53, 0x4C, 0x57,   // SL
                             0x7E, 0x00, 0x04, 0x08, 0x01, 0x43, 0x48, 0x6B};  // CH
    REQUIRE(booth.sent_bytes.size() > start_up.size());
    CHECK(start_up.size() == 64);
    CHECK(XBeeBytes(booth.sent_bytes.begin(), booth.sent_bytes.begin() + 64) == start_up);
    // The first heartbeat after 10.0 s: 3795 mV, nobody there.
    const auto reports = booth.reports();
    REQUIRE(reports.size() == 1);
    CHECK(ms(reports[0].first) == Approx(10'000).epsilon(0.01));
    CHECK(reports[0].second == XBeeBytes{0, 0, 0, 0, 0, 0xD3, 0x0E, 0});

    SECTION("a robot that enters is reported after some 386 ms, one that leaves as well") {
        const Time enters = booth.rig.board.now();
        booth.rig.board.set_signal(kBarrier + 1, 1.0);
        booth.run_until(enters + cosim::kSecond);
        auto now = booth.reports();
        REQUIRE(now.size() == 2);
        CHECK(now[1].second == XBeeBytes{0, 0, 0, 0, 1, 0xD3, 0x0E, 0});
        const double after = ms(now[1].first - enters);
        CHECK(after > 360);
        CHECK(after < 412 + 35);  // the report itself takes 28 ms on the line
        // While it is there, the byte for it is sent by infra-red: section 8.
        booth.rig.changes.clear();
        booth.changes_seen = 0;
        booth.command({0x0C, 0xA5});
        booth.run_until(enters + 2 * cosim::kSecond);
        const auto light = booth.rig.of(kProximityEmit);
        REQUIRE(light.size() > 100);
        const Time leaves = booth.rig.board.now();
        booth.rig.board.set_signal(kBarrier + 1, 0.0);
        booth.run_until(leaves + cosim::kSecond);
        now = booth.reports();
        REQUIRE(now.size() == 3);
        CHECK(now[2].second[4] == 0);
    }
    SECTION("words that a robot sends by infra-red are reported") {
        booth.rig.board.set_signal(kBarrier + 1, 1.0);
        booth.run_until(booth.rig.board.now() + cosim::kSecond);
        for (const int word : {5, 79, 116, 153, 190}) {
            // Half duplex: the booth listens between its own words, which come every 208 ms.
            booth.run_until_word();
            const Time begin = booth.rig.board.now() + 60 * kMs;
            booth.hear(static_cast<std::uint8_t>(word), begin);
            booth.run_until(begin + 300 * kMs);
            CHECK(static_cast<int>(booth.reports().back().second[7]) == word);
        }
    }
    SECTION("SET_LEDS writes twelve registers in the stated order and is answered with a report") {
        booth.rig.phases.clear();
        booth.command({0x0A, 0x19, 0x00, 0x0C});
        booth.run_until(booth.rig.board.now() + 500 * kMs);
        std::vector<std::pair<int, int>> writes;
        for (std::size_t i = 0; i + 2 < booth.rig.phases.size(); ++i)
            if (booth.rig.phases[i].kind == cosim::I2cPhaseKind::Start) {
                const int number = booth.rig.phases[i + 1].byte, value = booth.rig.phases[i + 2].byte;
                if (number < 0x12) writes.emplace_back(number, value);
            }
        const std::vector<std::pair<int, int>> expected{
            {0x09, 0x10}, {0x06, 0x10}, {0x03, 0x10}, {0x11, 0x19}, {0x0B, 0},    {0x08, 0},
            {0x05, 0},    {0x10, 0},    {0x0A, 0x0C}, {0x07, 0x0C}, {0x04, 0x0C}, {0x0F, 0x0C}};
        CHECK(writes == expected);
        const auto now = booth.reports();
        REQUIRE(now.size() == 2);
        CHECK(now[1].second == XBeeBytes{0, 0x19, 0x00, 0x0C, 0, 0xD3, 0x0E, 0});
    }
    SECTION("the command 0D switches it off half a second later") {
        const Time asked = booth.rig.board.now();
        booth.command({0x0D});
        booth.run_until(asked + cosim::kSecond);
        const auto clear = booth.rig.of(kPowerClear);
        REQUIRE(clear.size() >= 1);
        CHECK(ms(clear[0].at - asked) ==
              Approx(515).margin(25));  // 0.49 s after the frame, which takes 20 ms
        CHECK_FALSE(booth.rig.board.powered());
    }
    SECTION("a report that is not acknowledged is repeated while the state differs") {
        booth.acknowledges = false;
        const Time enters = booth.rig.board.now();
        booth.rig.board.set_signal(kBarrier + 1, 1.0);
        booth.run_until(enters + 4 * cosim::kSecond);
        const auto now = booth.reports();
        REQUIRE(now.size() >= 4);
        CHECK(ms(now[3].first - now[2].first) == Approx(1017).epsilon(0.03));
    }
    SECTION("an empty battery switches it off") {
        booth.rig.board.set_signal(kBattery, 2.6);
        booth.run_until(booth.rig.board.now() + 3 * cosim::kSecond);
        CHECK_FALSE(booth.rig.board.powered());
    }
}
