// Small programs that know of no emulator, under the preloaded library.

#include "base/random.h"
#include "linuxboard/shim/wire/board_clock.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <atomic>
#include <chrono>
#include <set>
#include <thread>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

TEST_CASE("bytes go to the program and back at 115200 baud") {
    linuxboard::LinuxSpec spec = spec_for("echo");
    spec.fifo_trigger = 1;
    Bench bench(std::move(spec));
    bench.send(5 * kMillisecond, "ABC");
    bench.send(8 * kMillisecond, std::string(1, '\0'));
    bench.run(20 * kMillisecond);
    CHECK(bench.sent() == "BCD");
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
    CHECK(bench.node().stop()->reason.find("exited with status 0") != std::string::npos);
    // The first byte is there in the middle of its stop bit, 9.5 bit times after its start; the answer begins
    // after two charged calls (the read that returned is charged before it waits, the write 2 us).
    const Time expected = 5 * kMillisecond + Time{9} * 8'680'555 + 8'680'556 / 2 + 2 * kMicrosecond;
    const Time start = std::stoll(bench.trace().substr(bench.trace().find("uart ") + 5));
    CHECK(start == Approx(expected).margin(20.0));
}

TEST_CASE("the receive FIFO waits for eight characters or a pause of four") {
    Bench bench(spec_for("vmin", {"1", "0"}));
    bench.send(50 * kMillisecond, "0123456789");
    bench.send(90 * kMillisecond, "ab");
    bench.run(kSecond);
    CHECK(bench.log() == "8 bytes at 50 ms\n2 bytes at 51 ms\n2 bytes at 90 ms\nnonblocking -1\n");
}

TEST_CASE("clocks and sleeps follow simulated time") {
    Bench bench(spec_for("clocks"));
    bench.run(2 * kSecond);
    CHECK(bench.log().find("host epuck12\n") == 0);
    // Sleeps end on the picosecond; the clock reading after each costs 1 us.
    CHECK(bench.log().find("10001 20001 30001 0\n") != std::string::npos);
    CHECK(bench.log().find("mono 60, wall 1767225600") != std::string::npos);
    CHECK(bench.sent() == std::string("\0\1\2\3\4", 5));
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
    CHECK(to_seconds(bench.node().stop()->time) == Approx(0.3).margin(0.001));
}

TEST_CASE("sleeps end late, or early, on a board that oversleeps, waits for a device do not") {
    auto spec = spec_for("clocks");
    spec.oversleep.mean = 4 * kMillisecond;
    Bench late(std::move(spec));
    late.run(2 * kSecond);
    CHECK(late.log().find("14001 24001 30001 0\n") != std::string::npos);  // usleep, nanosleep, select
    spec = spec_for("clocks");
    spec.oversleep.mean = -4 * kMillisecond;
    Bench early(std::move(spec));
    early.run(2 * kSecond);
    CHECK(early.log().find("6001 16001 30001 0\n") != std::string::npos);
    spec = spec_for("clocks");
    spec.oversleep.jitter = kMillisecond;
    const std::string plain = "10001 20001 30001 0\n";
    Bench unsteady(spec), again(spec);
    unsteady.run(2 * kSecond);
    again.run(2 * kSecond);
    CHECK(unsteady.log().find(plain + plain + plain + plain + plain) == std::string::npos);
    CHECK(unsteady.log() == again.log());
}

TEST_CASE("a board's clock that is fast counts more, and its sleeps are shorter") {
    // 1 % fast: of 10, 20 and 30 ms by its clock it takes 9.9, 19.8 and 29.7 ms. By its own clock, which is
    // all that it sees, nothing is different.
    const std::string plain = "10001 20001 30001 0\n";
    auto spec = spec_for("clocks");
    Bench ideal(spec);
    ideal.run(2 * kSecond);
    spec.system_clock_ppm = 10'000;
    Bench fast(spec);
    fast.run(2 * kSecond);
    spec.system_clock_ppm = -10'000;
    Bench slow(spec);
    slow.run(2 * kSecond);
    for (Bench* bench : {&ideal, &fast, &slow}) {
        REQUIRE(bench->node().stop());
        CHECK(bench->log().find("1000") != std::string::npos);
    }
    const double usual = to_seconds(ideal.node().stop()->time);
    CHECK(to_seconds(fast.node().stop()->time) / usual == Approx(1 / 1.01).epsilon(1e-4));
    CHECK(to_seconds(slow.node().stop()->time) / usual == Approx(1 / 0.99).epsilon(1e-4));
    CHECK(ideal.log().find(plain) != std::string::npos);
}

TEST_CASE("the clock of a board never reads less than was slept for") {
    using linuxboard::wire::board_time, linuxboard::wire::simulated_time;
    RandomStream random(7, "clock");
    for (int i = 0; i < 10'000; ++i) {
        const auto error = static_cast<std::int64_t>(random.below(20'000'001)) - 10'000'000;
        const auto counted =
            static_cast<std::int64_t>(random.below(std::uint64_t{1} << (1 + random.below(62))));
        const std::int64_t time = simulated_time(counted, error);
        REQUIRE(board_time(time, error) >= counted);
        REQUIRE((time == 0 || board_time(time - 1, error) < counted));
    }
    CHECK(simulated_time(INT64_MAX, -5) == INT64_MAX);
    CHECK(board_time(123'456'789, 0) == 123'456'789);
}

TEST_CASE("a serial port is found by its other names") {
    auto spec = spec_for("echo");  // opens /dev/ttyS0
    spec.tty = "/dev/ttyO7";
    spec.tty_aliases = {"/dev/serial0", "/dev/ttyS0"};
    Bench bench(std::move(spec));
    bench.send(5 * kMillisecond, "AB");
    bench.send(8 * kMillisecond, std::string(1, '\0'));
    bench.run(20 * kMillisecond);
    CHECK(bench.sent() == "BC");
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
}

TEST_CASE("received bytes wait for the driver's tick") {
    auto spec = spec_for("vmin", {"1", "0"});
    spec.tty_batch = 20 * kMillisecond;
    Bench bench(std::move(spec));
    bench.send(50 * kMillisecond, "0123456789");
    bench.send(90 * kMillisecond, "ab");
    bench.send(121 * kMillisecond, "c");
    bench.run(kSecond);
    CHECK(bench.log() == "10 bytes at 60 ms\n2 bytes at 100 ms\n1 bytes at 140 ms\nnonblocking -1\n");
}

TEST_CASE("VMIN and VTIME are kept") {
    const auto run = [](const char* vmin, const char* vtime, bool send) {
        Bench bench(spec_for("vmin", {vmin, vtime}));
        if (send) {
            bench.send(50 * kMillisecond, "abc");
            bench.send(120 * kMillisecond, "def");
            bench.send(500 * kMillisecond, "gh");
            bench.send(900 * kMillisecond, "i");
        }
        bench.run(3 * kSecond);
        return bench.log();
    };
    CHECK(run("3", "0", true) == "3 bytes at 50 ms\n3 bytes at 120 ms\n3 bytes at 900 ms\nnonblocking -1\n");
    CHECK(run("0", "2", true) == "3 bytes at 50 ms\n3 bytes at 120 ms\n0 bytes at 320 ms\nnonblocking -1\n");
    CHECK(run("10", "2", true) ==
          "6 bytes at 320 ms\n2 bytes at 700 ms\n1 bytes at 1100 ms\nnonblocking -1\n");
    CHECK(run("0", "3", false) ==
          "0 bytes at 300 ms\n0 bytes at 600 ms\n0 bytes at 900 ms\nnonblocking -1\n");
}

TEST_CASE("threads run in an order that simulated time decides") {
    std::string first;
    for (const Time slice : {70 * kMicrosecond, 13 * kMicrosecond, 1 * kMicrosecond}) {
        Bench bench(spec_for("threads"), slice);
        bench.run(kSecond);
        REQUIRE(bench.node().stop());
        CHECK(bench.node().stop()->success);
        CHECK(bench.sent().size() == 52);
        CHECK(bench.sent().ends_with("!C"));
        if (first.empty()) first = bench.trace();
        CHECK(bench.trace() == first);
    }
}

TEST_CASE("ten runs on a busy machine leave one and the same trace") {
    std::atomic<bool> stop{false};
    std::vector<std::thread> load;
    for (int i = 0; i < 3; ++i) {
        load.emplace_back([&stop] {
            while (!stop) {
            }
        });
    }
    std::set<std::string> traces;
    for (int i = 0; i < 10; ++i) {
        Bench bench(spec_for("threads"), (10 + 6 * i) * kMicrosecond);
        bench.run(kSecond);
        traces.insert(bench.trace());
    }
    stop = true;
    for (std::thread& thread : load)
        thread.join();
    CHECK(traces.size() == 1);
}

TEST_CASE("the threads of the C++ library wait in simulated time") {
    std::string first;
    for (int i = 0; i < 3; ++i) {
        Bench bench(spec_for("modern"));
        bench.run(kSecond);
        REQUIRE(bench.node().stop());
        INFO(bench.node().stop()->reason);
        CHECK(bench.node().stop()->success);
        CHECK(bench.sent() == "TNWFA");
        CHECK(bench.log().starts_with("11 ms, random "));
        if (first.empty()) first = bench.trace() + bench.log();
        CHECK(bench.trace() + bench.log() == first);
    }
}

TEST_CASE("I2C transfers take their time on the bus") {
    Bench bench(spec_for("ground"));
    bench.add_device(0x60, {{0, 0x03}, {1, 0x20}, {2, 0x02}, {3, 0x10}, {4, 0x01}, {5, 0xff}});
    bench.run(kSecond);
    CHECK(bench.log() == "03 20 02 10 01 ff | 2 02 10 | 0 20 | -1 Remote I/O error\n");
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
    // Six times (2 + 2 bytes and a STOP each), 5 bytes, 4 bytes, 1 byte: 34 bytes of 90 us and 15 STOPs.
    CHECK(to_seconds(bench.node().stop()->time) == Approx(0.00325).margin(0.0001));
}

TEST_CASE("each I2C transfer waits while the bus is held") {
    auto spec = spec_for("ground");
    spec.i2c_hold = 2 * kMillisecond;
    Bench bench(std::move(spec));
    bench.add_device(0x60, {{0, 0x03}, {1, 0x20}, {2, 0x02}, {3, 0x10}, {4, 0x01}, {5, 0xff}});
    bench.run(kSecond);
    CHECK(bench.log() == "03 20 02 10 01 ff | 2 02 10 | 0 20 | -1 Remote I/O error\n");
    REQUIRE(bench.node().stop());
    // Six times write and read, one of two messages, ...: the same as without, and 2 ms more for each of 15.
    CHECK(to_seconds(bench.node().stop()->time) == Approx(0.00325 + 15 * 0.002).margin(0.0001));
}

TEST_CASE("a sleep costs little wall-clock time") {
    // Two process switches a sleep; 100 us leaves room for a loaded machine (about 10 us on an idle one).
    constexpr int kSleeps = 2000;
    Bench bench(spec_for("beat", {std::to_string(kSleeps), "1000"}), 500 * kMicrosecond);
    const auto start = std::chrono::steady_clock::now();
    bench.run(10 * kSecond);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    CHECK(bench.log() == "2000001\n");
    WARN("a sleep costs " << took.count() / kSleeps * 1e6 << " us");
}

TEST_CASE("in real-time mode the wall clock paces the program") {
    linuxboard::LinuxSpec spec = spec_for("beat", {"10", "20000"});
    spec.real_time = true;
    Bench bench(std::move(spec));
    const auto start = std::chrono::steady_clock::now();
    // Until the program ends: the more a machine has to do, the later that is by both clocks.
    bench.run(3600 * kSecond);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
    REQUIRE(bench.node().stop());
    CHECK(bench.node().stop()->success);
    const double own_clock = static_cast<double>(std::stol(bench.log())) * 1e-6;
    CHECK(own_clock >= 0.2);
    CHECK(took.count() >= own_clock);  // which never runs ahead
}
