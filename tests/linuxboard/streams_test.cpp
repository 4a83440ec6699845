// Streams of the C library, and of programs that use them, on the serial port: whatever becomes of their
// descriptors, every byte is on the wire.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <unistd.h>

#include <filesystem>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {
struct Ran {
    std::string sent, log;
    bool success = false;
};

Ran run(linuxboard::LinuxSpec spec, const std::string& input = {}, Time slice = 70 * kMicrosecond) {
    Bench bench(std::move(spec), slice);
    if (!input.empty()) bench.send(500 * kMillisecond, input);
    bench.run(3 * kSecond);
    const auto stop = bench.node().stop();
    bench.run(bench.now() + 20 * kMillisecond, true);  // what is still to go out
    INFO((stop ? stop->reason : "still runs"));
    return {bench.sent(), bench.log(), stop && stop->success};
}

linuxboard::LinuxSpec command(const std::string& program, std::vector<std::string> args) {
    linuxboard::LinuxSpec spec = spec_for("streams");
    spec.program = program;
    spec.args = std::move(args);
    return spec;
}

const std::string kRaw = "stty -F /dev/ttyS0 raw -echo 115200; ";
}  // namespace

TEST_CASE("a stream that is or becomes the serial port loses nothing") {
    const std::string how =
        GENERATE(values<std::string>({"dup2", "puts", "unlocked", "unbuffered", "before", "kept", "freopen",
                                      "fdopen", "fopen", "dprintf", "path", "fork", "exec"}));
    CAPTURE(how);
    const Ran ran = run(spec_for("streams", {how}));
    CAPTURE(ran.log);
    const std::string end = how == "puts" ? "\n" : "";
    // Where the program does not set it up, the port is as the kernel makes it: lines end with CR LF.
    CHECK(ran.sent == "hello" + end);
    CHECK(ran.success);
    const Ran again = run(spec_for("streams", {how}), {}, 13 * kMicrosecond);
    CHECK(again.sent == ran.sent);
}

TEST_CASE("error messages go to a serial port that is standard error") {
    const Ran ran = run(spec_for("streams", {"perror"}));
    CHECK(ran.sent == "hello: No such file or directory\ntest_streams: hello\n");
}

TEST_CASE("a stream reads from the serial port and answers") {
    const Ran ran = run(spec_for("streams", {"read"}), "one line\ntwo words\n");
    CHECK(ran.sent == "one linetwo");
    CHECK(ran.success);
}

TEST_CASE("a stream on the serial port is a terminal's: it sends each line and cannot be positioned") {
    const Ran ran = run(spec_for("streams", {"tty"}));
    CHECK(ran.sent == "hello\nworld");
    CHECK(ran.log == "seek -1 29\n");  // ESPIPE
}

TEST_CASE("programs whose output is redirected to the serial port send it") {
    const auto [shell, script] = GENERATE(table<std::string, std::string>({
        {"/bin/bash", "printf 'h\\x01\\x00\\x02' > /dev/ttyS0"},
        {"/bin/bash", "exec > /dev/ttyS0; printf 'h\\x01'; printf '\\x00\\x02'"},
        {"/bin/bash", "exec 3<>/dev/ttyS0; echo -ne 'h\\x01\\x00\\x02' >&3"},
        {"/bin/bash", "{ printf 'h\\x01'; /usr/bin/printf '\\0\\2'; } > /dev/ttyS0"},
        {"/bin/dash", "printf 'h\\001\\000\\002' > /dev/ttyS0"},
        {"/bin/dash", "printf 'h\\001\\000\\002' | tee /dev/ttyS0 > /dev/null"},
        {"/bin/dash", "printf 'h\\001\\000\\002' | dd of=/dev/ttyS0 2> /dev/null"},
        {"/bin/dash", "printf 'h\\001\\000\\002' | cat > /dev/ttyS0"},
        {"/bin/dash", "awk 'BEGIN { printf \"h\\001%c\\002\", 0 }' > /dev/ttyS0"},
        {"/bin/dash", "awk 'BEGIN { printf \"h\\001%c\\002\", 0 > \"/dev/ttyS0\" }'"},
        {"/bin/dash", "perl -e 'print \"h\\x01\\x00\\x02\"' > /dev/ttyS0"},
        {"/bin/dash", "printf 'h\\001\\000\\002' > /dev/stdout > /dev/ttyS0"},
    }));
    CAPTURE(shell, script);
    const Ran ran = run(command(shell, {"-c", kRaw + script}));
    CAPTURE(ran.log);
    CHECK(ran.sent == std::string("h\1\0\2", 4));
    CHECK(ran.success);
}

TEST_CASE("Python's standard streams on the serial port") {
    const std::string python = "/usr/bin/python3";
    if (!std::filesystem::exists(python)) {
        WARN("python3 is not there: skipped");
        return;
    }
    const Ran ran = run(command("/bin/dash", {"-c", kRaw + python +
                                                        " -c 'import sys; print(input()[::-1], end=\"\")' "
                                                        "< /dev/ttyS0 > /dev/ttyS0"}),
                        "olleh\n");
    CAPTURE(ran.log);
    CHECK(ran.sent == "hello");
}

TEST_CASE("a shell reads lines from the serial port") {
    const Ran ran =
        run(command("/bin/bash", {"-c", kRaw + "read -r a b < /dev/ttyS0; echo -n \"$b $a\" > /dev/ttyS0"}),
            "one two\n");
    CHECK(ran.sent == "two one");
}
