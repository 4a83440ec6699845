// The control program's session against a model of both firmwares, without a wall clock: every fault must end
// with both sides in step, the wheels obeying what was last commanded.

#include "base/random.h"
#include "linuxboard/control/control_loop.h"
#include "tests/linuxboard/simulated_line.h"

#include <catch2/catch.hpp>

using namespace puckloop::control;
using puckloop::protocols::EpuckActuators;

namespace {

/// Commands that show by themselves whether a record arrived unshifted.
class Signature : public Behaviour {
  public:
    Actuators step(const Sensors&, double) override {
        ++steps;
        return {.left_mm_s = 300 * kMillimetresPerStep,
                .right_mm_s = -200 * kMillimetresPerStep,
                .ring_leds = 0x05};
    }
    long steps = 0;
};

struct Bench {
    explicit Bench(FirmwareCharacter character) : line(character) {
        line.sensors.battery_ok = 1;
        line.sensors.light.fill(3800);
        settings.duration = 3;
    }
    bool run() {
        const bool reached = run_control_loop(
            session, line, behaviour, Surroundings{}, [this] { return line.now() >= interrupt_at; },
            settings);
        ended = line.now();
        line.sleep_until(ended + 0.2);  // what was written last arrives
        return reached;
    }
    bool good(const EpuckActuators& a) const {
        return a.left == 300 && a.right == -200 && a.ring_leds == 0x05;
    }
    bool rest(const EpuckActuators& a) const { return a.left == 0 && a.right == 0; }

    SimulatedLine line;
    Signature behaviour;
    double interrupt_at = 1e300;
    double ended = 0;
    std::vector<std::string> log;
    Session session{line, [this](const std::string& text) { log.push_back(text); },
                    [this] { return line.now() >= interrupt_at; }};
    LoopSettings settings;
};

/// After the fault the last commanded record arrived whole, then rest, then the end; nothing is left over.
void check_recovered(Bench& bench) {
    const auto& obeyed = bench.line.pic.obeyed;
    REQUIRE(obeyed.size() >= 4);
    CHECK(obeyed.back().reset == puckloop::protocols::kEpuckEnd);
    CHECK(bench.rest(obeyed[obeyed.size() - 2]));
    CHECK(bench.good(obeyed[obeyed.size() - 3]));
    CHECK_FALSE(bench.line.pic.in_session());
    CHECK(bench.line.pic.pending() == 0);
}

const FirmwareCharacter kCharacters[] = {kOriginalFirmware, kOwnFirmware};

}  // namespace

TEST_CASE("a quiet session: one record each 100 ms, all answered, then the end") {
    for (const FirmwareCharacter& character : kCharacters) {
        Bench bench(character);
        bench.settings.duration = 60;
        REQUIRE(bench.run());
        const SessionCounters& c = bench.session.counters();
        CHECK(c.frames == 600);
        CHECK(c.records == 601);  // one more answers the configuration
        CHECK(c.resyncs == 0);
        CHECK(c.stray_bytes == 0);
        CHECK(bench.line.sent == 1 + 4 + 601 * 12);
        CHECK(bench.line.pic.obeyed.size() == 601);
        CHECK(bench.line.pic.sessions == 1);
        CHECK(bench.behaviour.steps == 599);  // the last record is rest
        check_recovered(bench);
    }
}

TEST_CASE("a byte to the PIC lost, doubled or garbled, anywhere in a record") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (unsigned long offset = 0; offset < 12; ++offset) {
            for (const int copies : {0, 2, 3}) {
                Bench bench(character);
                bench.line.copies_to_pic[5 + 120 + offset] = copies;
                REQUIRE(bench.run());
                INFO("offset " << offset << " copies " << copies);
                check_recovered(bench);
                // Our firmware drops the part and answers it: only that record is not obeyed.
                if (character.partial_timeout <= 0) CHECK(bench.session.counters().resyncs >= 1);
                CHECK(bench.session.counters().longest_gap < 0.65);
            }
            for (const int wrong : {0x01, 0x1C, 0xFF}) {  // 0x1C makes 'R' of 'N'
                Bench bench(character);
                bench.line.garble_to_pic[5 + 120 + offset] = static_cast<std::uint8_t>(wrong);
                REQUIRE(bench.run());
                INFO("offset " << offset << " garbled by " << wrong);
                check_recovered(bench);
            }
        }
    }
}

TEST_CASE("a byte from the PIC lost, doubled or garbled") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (unsigned long offset = 0; offset < 72; offset += 5) {
            for (const int copies : {0, 2}) {
                Bench bench(character);
                bench.line.copies_to_linux[72 * 10 + offset] = copies;
                REQUIRE(bench.run());
                INFO("offset " << offset << " copies " << copies);
                check_recovered(bench);
                CHECK(bench.session.counters().resyncs == 0);  // the PIC is in step: only one record is lost
                CHECK(bench.session.counters().records >= 29);
            }
            Bench bench(character);
            bench.line.garble_to_linux[72 * 10 + offset] = 0x80;
            REQUIRE(bench.run());
            check_recovered(bench);
            CHECK(bench.session.counters().resyncs == 0);
        }
    }
}

TEST_CASE("several faults in one record, and in the recovery itself") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (unsigned long first = 125; first < 137; ++first) {
            Bench bench(character);
            bench.line.copies_to_pic[first] = 0;
            bench.line.copies_to_pic[first + 2] = 2;
            bench.line.copies_to_pic[first + 9] = 0;
            bench.line.copies_to_pic[140] = 0;
            bench.line.copies_to_pic[147] = 2;
            bench.line.copies_to_linux[72 * 11 + 7] = 0;
            REQUIRE(bench.run());
            INFO("first " << first);
            check_recovered(bench);
        }
    }
}

TEST_CASE("noise on both lines for seconds: in step again when it ends") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (unsigned long seed = 1; seed <= 60; ++seed) {
            puckloop::RandomStream random(seed, "line noise");
            Bench bench(character);
            bench.settings.duration = 20;
            for (unsigned long byte = 60; byte < 600; ++byte) {  // about 5 s of records
                if (random.below(40) == 0) bench.line.copies_to_pic[byte] = static_cast<int>(random.below(3));
                if (random.below(40) == 0)
                    bench.line.garble_to_pic[byte] = static_cast<std::uint8_t>(random.below(256));
            }
            for (unsigned long byte = 0; byte < 3600; ++byte) {
                if (random.below(200) == 0)
                    bench.line.copies_to_linux[byte] = static_cast<int>(random.below(3));
                if (random.below(200) == 0)
                    bench.line.garble_to_linux[byte] = static_cast<std::uint8_t>(random.below(256));
            }
            INFO("seed " << seed << " " << character.boot);
            REQUIRE(bench.run());
            check_recovered(bench);
        }
    }
}

TEST_CASE("a late answer is waited out and does not shift the session") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (const double delay : {0.01, 0.05, 0.07, 0.12, 0.2}) {
            Bench bench(character);
            bench.line.late = 0;
            bench.line.sleep_until(0.5);
            bench.line.late = delay;  // the answer to the configuration
            REQUIRE(bench.run());
            INFO("delay " << delay);
            check_recovered(bench);
        }
    }
}

TEST_CASE("the PIC restarts in mid-session") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (const double at : {1.0, 1.203, 1.204, 1.25}) {
            Bench bench(character);
            bench.settings.duration = 60;
            bench.line.restarts = {at};
            REQUIRE(bench.run());
            INFO("restart at " << at);
            check_recovered(bench);
            CHECK(bench.line.pic.sessions >= 2);
            CHECK(bench.session.counters().longest_gap < character.boot + 2.5);
        }
    }
}

TEST_CASE("the PIC is still booting when the program starts") {
    for (const FirmwareCharacter& character : kCharacters) {
        Bench bench(character);
        bench.line.restarts = {0.0};
        REQUIRE(bench.run());
        check_recovered(bench);
    }
}

TEST_CASE("the program restarts while the PIC is inside a session") {
    for (const FirmwareCharacter& character : kCharacters) {
        for (unsigned left_over = 0; left_over < 12; ++left_over) {
            Bench bench(character);
            const std::vector<std::uint8_t> before(1 + 4 + 12 + left_over, 0);
            bench.line.write(before);
            bench.line.sleep_until(1.0);
            REQUIRE(bench.line.pic.in_session());
            REQUIRE(bench.run());
            INFO("left over " << left_over);
            check_recovered(bench);
        }
    }
}

TEST_CASE("an interrupt stops the wheels and ends the session") {
    for (const FirmwareCharacter& character : kCharacters) {
        Bench bench(character);
        bench.settings.duration = 0;
        bench.interrupt_at = 1.55;
        REQUIRE(bench.run());
        check_recovered(bench);
        CHECK(bench.ended < 2.0);
    }
}

TEST_CASE("a PIC that never answers ends the run without success") {
    Bench bench({.boot = 1e9, .deaf = 1e9});
    bench.line.restarts = {0.0};
    bench.settings.start_wait = 5;
    CHECK_FALSE(bench.run());
    CHECK(bench.ended < 8);
}

TEST_CASE("a PIC that falls silent for good ends the run without success") {
    Bench bench({.boot = 1e9, .deaf = 1e9});
    bench.line.restarts = {1.0};
    bench.settings.give_up = 5;
    CHECK_FALSE(bench.run());
    CHECK(bench.ended < 9);
}
