// The node's description: defaults, units, and what is refused with its key.

#include "base/error.h"
#include "linuxboard/shim/kernel/spec.h"

#include <catch2/catch.hpp>

#include <csignal>

using namespace puckloop;
using namespace puckloop::linuxboard;
using Catch::Contains;

TEST_CASE("a description with everything") {
    const LinuxSpec spec =
        parse_linux_spec(R"({"name": "robot0.linux", "program": "/bin/true", "args": ["-c", "x"],
        "env": {"A": "1"}, "host_name": "epuck7", "tty": "/dev/ttyS1", "i2c": ["/dev/i2c-0", "/dev/i2c-12"],
        "i2c_hertz": 400000, "i2c_nack_error": "ENXIO", "charges_us": {"clock": 0.5}, "start_s": 42,
        "restart_at": [{"time_s": 50}, {"time_s": 60, "down_s": 2}], "signals": [{"time_s": 1, "signal": "INT"}],
        "hangup_at": [70], "watchdog_s": 3})");
    CHECK(spec.i2c.size() == 2);
    CHECK(spec.i2c_nack_error == ENXIO);
    CHECK(spec.charges.clock == 500'000);
    CHECK(spec.start == 42 * cosim::kSecond);
    REQUIRE(spec.restarts.size() == 2);
    CHECK(spec.restarts[1].down == 2 * cosim::kSecond);
    CHECK(spec.signals[0].signal == SIGINT);
    CHECK(spec.hangups[0] == 70 * cosim::kSecond);
}

TEST_CASE("what cannot be meant is refused with its key") {
    const auto refuse = [](const char* text, const char* message) {
        CHECK_THROWS_WITH(parse_linux_spec(text), Contains(message));
    };
    refuse("{}", "linux: has no program");
    refuse(R"({"program": ""})", "linux.program");
    refuse("[", "linux program");
    refuse(R"({"program": "a", "prorgam": "b"})", "linux.prorgam");
    refuse(R"({"program": "a", "args": "b"})", "linux.args");
    refuse(R"({"program": "a", "start_s": -1})", "linux.start_s");
    refuse(R"({"program": "a", "charges_us": {"clock": 0}})", "linux.charges_us.clock");
    refuse(R"({"program": "a", "restart_at": [{"time_s": 5}, {"time_s": 4}]})", "linux.restart_at");
    refuse(R"({"program": "a", "signals": [{"time_s": 1, "signal": "FOO"}]})", "linux.signals[0].signal");
    refuse(R"({"program": "a", "i2c_nack_error": "EPERM"})", "linux.i2c_nack_error");
    refuse(R"({"program": "a", "fifo_trigger": 0})", "linux.fifo_trigger");
    refuse(R"({"program": "a", "tty_batch_s": -1})", "linux.tty_batch_s");
    refuse(R"({"program": "a", "oversleep": {"jitter_s": -1}})", "linux.oversleep.jitter_s");
}
