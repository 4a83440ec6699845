// Polling and sending in the background: the steps with a simulated clock, the threads with the real one.

#include "linuxboard/control/rab/rab_link.h"
#include "tests/linuxboard/simulated_rab.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace puckloop::control;

namespace {

struct Bench {
    explicit Bench(RabLinkSettings settings = {})
        : link(
              board, clock, [this](const std::string& line) { log.push_back(line); }, settings) {}

    /// Runs both steps in the order of their times.
    void run(double duration) {
        const double end = clock.time + duration;
        double poll = clock.time;
        double emit = clock.time;
        while (std::min(poll, emit) < end) {
            clock.sleep_until(std::min(poll, emit));
            if (poll <= emit) {
                poll = link.poll_step();
            } else {
                emit = link.emit_step();
            }
        }
    }

    SimulatedClock clock;
    SimulatedRab device{clock};
    RabBoard board{device, clock, {.bytes = 2}};
    std::vector<std::string> log;
    RabLink link;
};

}  // namespace

TEST_CASE("frames go out every 20 ms, varied by a tenth, once there is something to send") {
    Bench bench;
    REQUIRE(bench.link.initialise());
    bench.run(1);
    CHECK(bench.device.frames.empty());
    bench.link.say(0x0102);
    bench.run(10);
    CHECK(bench.device.frames.size() > 450);
    CHECK(bench.device.frames.size() < 515);
    CHECK(bench.link.counters().sent == bench.device.frames.size());
    double shortest = 1;
    double longest = 0;
    for (std::size_t i = 1; i < bench.device.frames.size(); ++i) {
        const double gap = bench.device.frames[i].time - bench.device.frames[i - 1].time;
        shortest = std::min(shortest, gap);
        longest = std::max(longest, gap);
    }
    CHECK(shortest > 0.0165);
    CHECK(shortest < 0.0190);
    CHECK(longest < 0.0235);
    CHECK(longest > 0.0205);
    bench.link.say(std::nullopt);
    const std::size_t so_far = bench.device.frames.size();
    bench.run(1);
    CHECK(bench.device.frames.size() == so_far);
}

TEST_CASE("robots with other ids vary their periods otherwise") {
    Bench one({.seed = 1});
    Bench two({.seed = 2});
    one.link.say(1);
    two.link.say(1);
    bool differ = false;
    for (int i = 0; i < 5; ++i)
        differ = differ || one.link.emit_step() - one.clock.time != two.link.emit_step() - two.clock.time;
    CHECK(differ);
}

TEST_CASE("nobody polls while the own frame is on the air") {
    Bench bench;
    REQUIRE(bench.link.initialise());
    bench.link.say(0x0102);
    bench.device.polls.clear();
    bench.run(5);
    CHECK(bench.device.polls.size() > 200);
    for (const SimulatedRab::Frame& frame : bench.device.frames)
        for (const double poll : bench.device.polls)
            CHECK_FALSE((poll > frame.time && poll < frame.time + rab::frame_seconds(2)));
}

TEST_CASE("all messages of the board are fetched, oldest first, and nothing is kept for ever") {
    Bench bench;
    REQUIRE(bench.link.initialise());
    for (std::uint32_t i = 0; i < 7; ++i)
        bench.device.receive({.data = i});
    bench.run(0.02);
    const std::vector<RabPacket> packets = bench.link.take();
    REQUIRE(packets.size() == 7);
    for (std::uint32_t i = 0; i < 7; ++i)
        CHECK(packets[i].payload == i);
    CHECK(bench.link.take().empty());
    for (int round = 0; round < 40; ++round) {
        for (std::uint32_t i = 0; i < 10; ++i)
            bench.device.receive({.data = i});
        bench.run(0.05);
    }
    CHECK(bench.link.take().size() == 256);
    CHECK(bench.link.counters().dropped == 400 - 256);
    CHECK(bench.link.counters().received == 407);
}

TEST_CASE("the emission power is set again once the board has surely booted") {
    Bench bench;
    REQUIRE(bench.link.initialise());
    bench.device.range = 100;  // what the board's boot does to an early setting
    bench.link.say(1);
    bench.run(0.5);
    CHECK(bench.device.range == rab::kDefaultRange);
    const auto settings = std::count(bench.device.writes.begin(), bench.device.writes.end(),
                                     std::pair<std::uint8_t, std::uint8_t>{12, 115});
    CHECK(settings == 2);
}

TEST_CASE("no board: reported after the wait, a late one is found") {
    Bench absent({.start_wait = 0.3});
    absent.device.refuse = 1000000;
    CHECK_FALSE(absent.link.initialise());
    CHECK(absent.clock.time < 0.4);
    Bench late;
    late.device.refuse = 20;
    CHECK(late.link.initialise());
}

TEST_CASE("a board that goes away is reported once, and set up again when it is back") {
    Bench bench;
    REQUIRE(bench.link.initialise());
    bench.link.say(1);
    bench.run(1);
    bench.device.refuse = 1000000;
    bench.run(5);
    REQUIRE(bench.log.size() == 1);
    CHECK(bench.log[0].find("does not answer any more: Remote I/O error") != std::string::npos);
    CHECK(1000000 - bench.device.refuse < 100);  // the bus is left to others
    bench.device.refuse = 0;
    bench.device.bits = 16;
    const std::size_t frames = bench.device.frames.size();
    bench.run(3);
    REQUIRE(bench.log.size() == 2);
    CHECK(bench.log[1].find("answers again") != std::string::npos);
    CHECK(bench.link.counters().setups == 2);
    CHECK(bench.device.frames.size() > frames + 50);
}

TEST_CASE("the threads start, work and end") {
    SimulatedClock board_clock;  // used under the link's lock only
    SimulatedRab device(board_clock);
    RabBoard board(device, board_clock, {});
    PosixClock clock;
    RabLink link(board, clock, [](const std::string&) {}, {.poll_period = 0.001, .emit_period = 0.020});
    REQUIRE(link.initialise());
    const std::size_t set_up = device.polls.size();
    link.say(0x0102);
    link.start();
    // Polls and frames make way for each other: either may be the last to come.
    const auto both_work = [&] { return link.counters().sent >= 5 && link.counters().polls > 1; };
    for (const double give_up = clock.now() + 10; !both_work() && clock.now() < give_up;)
        clock.sleep_until(clock.now() + 0.001);
    link.stop();
    REQUIRE(link.counters().sent >= 5);
    CHECK(device.frames.size() == link.counters().sent);
    CHECK(device.frames.front().payloads[3] == 0x0102U);
    CHECK(device.polls.size() > 1);
    CHECK(device.polls.size() - set_up == link.counters().polls);
}
