// The main board as an I2C slave, from its source to what a Linux program and a bench's script read; the same
// run in every placement and from its snapshots; published firmware (PUCKLOOP_IMAGES).

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/i2c/slave_programs.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cerrno>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// 0x5A to whoever reads from 0x1F. `address`: how I2CADD is set. Behind the vectors, in which the chip
/// executes nothing.
std::string source(const std::string& address = "mov #0x1f, w0\n mov w0, I2CADD\n") {
    return " goto start\n .org 0x200\nstart: mov #0x0900, w15\n mov #0x27f0, w0\n mov w0, SPLIM\n" + address +
           " mov #0x9240, w0\n mov w0, I2CCON\n"
           "loop: btss IFS0, #13\n bra loop\n bclr IFS0, #13\n btss I2CSTAT, #2\n bra wr\n mov I2CRCV, w1\n"
           " mov #0x5a, w0\n mov w0, I2CTRN\n bset I2CCON, #12\n bra loop\n"
           "wr: mov I2CRCV, w1\n bset I2CCON, #12\n bra loop\n";
}

std::string image(const Workbench& bench, const std::string& text) {
    const auto file = bench.file("slave.s", text);
    const std::string hex = (bench.folder() / "slave.hex").string();
    const Ended ended = bench.puckloop({"asm", file.string(), "-o", hex, "--mcu", "dspic30f6014a"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    return hex;
}

/// A robot whose Linux board runs `program`.
std::filesystem::path scene(const Workbench& bench, const std::string& hex, const std::string& more,
                            const Words& program) {
    std::string words;
    for (const std::string& word : program)
        words += (words.empty() ? "\"" : ", \"") + word + "\"";
    return bench.file("slave.toml",
                      fmt::format("[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[[robot]]\n"
                                  "position = [\"0 cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"{}\"\n{}"
                                  "[robot.linux]\nprogram = [{}]\nstart = \"100 ms\"\n",
                                  hex, more, words));
}

std::string printed(const Workbench& bench, const std::string& run) {
    return text_of(bench.out(run) / "robot0.linux.log");
}

/// What the program reads.
std::string read_in_run(const Workbench& bench, const std::string& hex, const std::string& more,
                        const std::string& address = "0x1f") {
    const auto file = scene(bench, hex, more, {PUCKLOOP_READ_REGISTER, "/dev/i2c-3", address, "0", "2"});
    const Ended ended = bench.run("o", {file.string(), "--no-cache"});
    INFO(ended.err);
    return printed(bench, "o");
}

}  // namespace

TEST_CASE("a Linux program reads register 0 of the main board at 0x1F") {
    const Workbench bench;
    const std::string hex = image(bench, source());
    CHECK_THAT(read_in_run(bench, hex, ""), Contains("5a5a"));
    CHECK_THAT(read_in_run(bench, hex, "", "0x1e"), Contains(fmt::format("error {}", EREMOTEIO)));
    CHECK_THAT(read_in_run(bench, hex, "i2c_slave = false\n"), Contains(fmt::format("error {}", EREMOTEIO)));
}

TEST_CASE("an address set through a pointer is no slave by itself, and one where the scenario says so") {
    const Workbench bench;
    const std::string hex = image(bench, source("mov #0x1f, w0\n mov #I2CADD, w2\n mov w0, [w2]\n"));
    CHECK_THAT(read_in_run(bench, hex, ""), Contains(fmt::format("error {}", EREMOTEIO)));
    CHECK_THAT(read_in_run(bench, hex, "i2c_slave = true\n"), Contains("5a5a"));
}

TEST_CASE("a Linux program reaches a ten-bit address by I2C_M_TEN and by I2C_TENBIT") {
    const Workbench bench;
    constexpr int kTenBits = 0x400;
    const std::string hex =
        image(bench, "        goto main\n" + register_file(0x2A5, kEnabled | kTenBits, "rest: bra rest\n"));
    const auto run = [&](const Words& program, int status = 0) {
        const Ended ended = bench.run("o", {scene(bench, hex, "", program).string(), "--no-cache"});
        INFO(ended.err);
        CHECK(ended.status == status);
        return printed(bench, "o");
    };
    CHECK_THAT(
        run({PUCKLOOP_SMBUS_REGISTERS, "/dev/i2c-3", "ten:0x2a5", "1", "w:8=513", "b:3=7", "w:8", "b:3"}),
        Contains("w:8=513 b:3=7 \n"));
    CHECK_THAT(run({PUCKLOOP_SMBUS_REGISTERS, "/dev/i2c-3", "ten:0x2a4", "1", "b:3"}),
               Contains(fmt::format("error {}", EREMOTEIO)));
    CHECK_THAT(run({PUCKLOOP_READ_REGISTER, "/dev/i2c-3", "0x2a5", "3", "2", "ten"}), Contains("0000"));
    CHECK_THAT(run({PUCKLOOP_READ_REGISTER, "/dev/i2c-3", "0x1a5", "3", "2", "ten"}, 1),
               Contains(fmt::format("error {}", EREMOTEIO)));
}

TEST_CASE("on the bench a script reads the main board, and the bare chip") {
    const Workbench bench;
    const std::string hex = image(bench, source());
    const auto script = bench.file("bus.txt", "0.01 r 0x1f 0 2\n0.02 w 0x1f 01 02\n0.03 r 0x1e 0 1\n");
    for (const Words& target : {Words{"--board", "pic"}, Words{"--mcu", "dspic30f6014a"}}) {
        Words words{"exec", hex, "--i2c", "script:" + script.string(), "--seconds", "0.05"};
        words.insert(words.end(), target.begin(), target.end());
        const Ended ended = bench.puckloop(words);
        INFO(ended.err);
        CHECK(ended.status == 0);
        CHECK_THAT(ended.out + ended.err, Contains("0x1f register 0: 5a 5a"));
        CHECK_THAT(ended.out + ended.err, Contains("1 addresses"));
    }
}

TEST_CASE("on the bench: general call, ten-bit addresses, masters that break the protocol") {
    const Workbench bench;
    constexpr int kGeneralCall = 0x80, kTenBits = 0x400;
    const std::string rest = "rest: bra rest\n";
    const auto played = [&](const std::string& firmware, const std::string& script) {
        const std::string hex = image(bench, "        goto main\n" + firmware);
        const auto file = bench.file("bus.txt", script);
        const Ended ended = bench.puckloop(
            {"exec", hex, "--board", "pic", "--i2c", "script:" + file.string(), "--seconds", "0.1"});
        INFO(ended.err);
        CHECK(ended.status == 0);
        return ended.out + ended.err;
    };
    CHECK_THAT(
        played(register_file(0x1F, kEnabled | kGeneralCall, rest), "0.01 w 0x00 06 11 22\n0.03 r 0x1f 6 2\n"),
        Contains("0 addresses and 0 bytes not acknowledged") && Contains("0x1f register 6: 11 22"));
    CHECK_THAT(played(register_file(0x2A5, kEnabled | kTenBits, rest),
                      "0.01 w ten:0x2a5 04 77 78\n0.03 r ten:0x2a5 4 2\n0.05 w ten:0x2a4 04 01\n"),
               Contains("0 addresses and 1 bytes not acknowledged (first on line 3)") &&
                   Contains("0x2a5 register 4: 77 78"));
    // What is written to a board that sends is not taken; a byte that is broken off is none; who reads from
    // one that is to receive gets ones, and the board has received them.
    CHECK_THAT(played(register_file(0x1F, kEnabled, rest),
                      "0.01 w 0x1f 06 11 22 33\n0.02 raw s3e w06 w44/5 p\n0.03 raw s3e w06 s3f wff n p\n"
                      "0.04 raw s3e w08 r r p\n0.05 r 0x1f 6 4\n"),
               Contains("0x1f register -: ff") && Contains("0x1f register 6: 11 22 ff ff"));
}

TEST_CASE("both roles at once: one run in every placement, and from snapshots of it") {
    const Workbench bench;
    const std::string hex = image(bench, "        goto main\n" + register_file(0x1F, kEnabled, kWritesToo));
    Words program{PUCKLOOP_SMBUS_REGISTERS, "/dev/i2c-3", "0x1f", "60"};
    for (const char* step : {"w:8=513", "b:3=7", "ms:1", "w:8", "b:3", "b:9", "ms:3"})
        program.emplace_back(step);
    const auto file = scene(bench, hex, "", program);
    const Words whole{file.string(), "--no-cache", "--in-process"};
    REQUIRE(bench.run("whole", whole).status == 0);
    const std::string text = printed(bench, "whole");
    std::size_t lines = 0;
    for (std::size_t at = 0; (at = text.find("w:8=513 b:3=7 b:9=2 \n", at)) != std::string::npos; ++at)
        ++lines;
    INFO(text);
    CHECK(lines == 60);
    // The main board's own transfers, and ones that it lost.
    const auto bus = bench.report("whole")["nodes"]["robot0.i2c"];
    INFO(bus.dump());
    CHECK(bus["lost"] > 0);

    REQUIRE(bench.run("processes", {file.string(), "--no-cache"}).status == 0);
    check_same_run(bench, "whole", "processes");
    REQUIRE(bench.run("threads", {file.string(), "--no-cache", "--in-process", "--threads", "3"}).status ==
            0);
    check_same_run(bench, "whole", "threads");

    Words saving = whole;
    for (const char* at : {"0.1507", "0.2531", "0.40713"})
        saving.insert(saving.end(), {"--save-at", at});
    saving.insert(saving.end(), {"--save", bench.folder() / "run.snap"});
    const Ended saved = bench.run("saving", saving);
    INFO(saved.err);
    REQUIRE(saved.status == 0);
    check_same_run(bench, "whole", "saving");
    for (const char* at : {"0.1507", "0.2531", "0.40713"}) {
        INFO("from " << at);
        const auto snapshot = bench.folder() / fmt::format("run-{}s.snap", at);
        const Ended ended = bench.run("on", {"--from", snapshot.string()});
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        check_same_run(bench, "whole", "on");
        CHECK(printed(bench, "on") == text);
    }
}

// yorkrobotlab/pi-puck, e-puck1/pi-puck-e-puck1.hex; registers: its library, pipuck/epuck1.py. A word of
// register 2 and 3 is a wheel's speed in steps a second, of 4 and 5 its steps.
TEST_CASE("published firmware that is an I2C slave is driven over the bus", "[images]") {
    const auto firmware = outside("PUCKLOOP_IMAGES", "pi-puck-e-puck1.hex");
    if (!firmware) {
        WARN("PUCKLOOP_IMAGES has no pi-puck-e-puck1.hex: skipped");
        return;
    }
    const Workbench bench;
    Words program{PUCKLOOP_SMBUS_REGISTERS, "/dev/i2c-3", "0x1f", "1"};
    for (const char* step : {"b:0=15", "w:2=400", "w:3=-300", "ms:400", "w:2=0", "w:3=0", "ms:20", "w:2",
                             "w:4", "w:5", "b:0", "b:4", "w:4"})
        program.emplace_back(step);
    const auto file = scene(bench, firmware->string(), "", program);
    const Ended ended = bench.run("o", {file.string(), "--no-cache"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const std::string text = printed(bench, "o");
    INFO(text);
    CHECK(text.find("error") == std::string::npos);
    CHECK_THAT(text, Contains("w:2=0 "));
    CHECK_THAT(text, Contains("b:0=15 "));
    const auto steps = bench.report("o")["nodes"]["robot0.pic"]["wheel_steps"];
    const int left = steps["left"], right = steps["right"];
    CHECK(std::abs(left - 160) < 8);
    CHECK(std::abs(right + 120) < 8);
    CHECK_THAT(text, Contains(fmt::format("w:4={} w:5={} ", left, right)));
    CHECK_THAT(text, Contains(fmt::format("b:4={} w:4={} ", left & 0xFF, left)));
}
