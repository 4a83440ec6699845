// A robot that hangs looks hung: on the terminal, in report.json and in the exit status.

#include "tests/end_to_end/kit/workbench.h"
#include "tests/kit/dspic_pieces.h"

#include <catch2/catch.hpp>

#include <fstream>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// Waits for a failure of the oscillator, which no model makes.
const std::string kWaitsForReference = kMain + R"(
        bset    RCON, #12
wait:   btss    INTCON1, #1
        bra     wait
        bra     wait
)";
/// Writes BSRAM, which no model stands behind, and then waits for a character.
const std::string kWaitsForCharacter = kMain + R"(
        mov     w0, BSRAM
)" + kWaitForCharacter;
/// Asks address 0x33 on I2C once, and waits for a character.
const std::string kAsksNobody = kMain + R"(
        mov     #72, w0
        mov     w0, I2CBRG
        bset    I2CCON, #15
        bset    I2CCON, #0
s:      btsc    I2CCON, #0
        bra     s
        mov     #0x66, w0
        mov     w0, I2CTRN
t:      btsc    I2CSTAT, #14
        bra     t
        bset    I2CCON, #2
)" + kWaitForCharacter;

std::string image(const Workbench& bench, const std::string& name, const std::string& source) {
    const std::string hex = (bench.folder() / (name + ".hex")).string();
    const Ended ended = bench.puckloop({"asm", bench.file(name + ".s", source).string(), "-o", hex});
    REQUIRE(ended.status == 0);
    return hex;
}

std::string scenario(const Workbench& bench, const std::string& hex) {
    return bench
        .file("s.toml", "[run]\nduration = \"2 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n[[robot]]\n"
                        "position = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"" +
                            hex + "\"\n")
        .string();
}

}  // namespace

TEST_CASE("exec names the bit that hangs the program, and --strict makes it status 1", "[hung]") {
    const Workbench bench;
    const std::string hex = image(bench, "bgst", kWaitsForReference);
    const std::string line = "warning: has run 3.0 s in the loop 0x0108..0x010a reading INTCON1, bit "
                             "OSCFAIL, which no model drives\n";
    const Ended plain = bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "3"});
    CHECK(plain.status == 0);
    CHECK_THAT(plain.out, Contains(line));
    const Ended strict = bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "3", "--strict"});
    CHECK(strict.status == 1);
    CHECK_THAT(strict.out,
               Contains("failed: with --strict a warning is a failure: has run 3.0 s in the loop"));
    // Somebody at a live end is not kept waiting for the summary.
    const Ended live = bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "2.2", "--realtime"});
    CHECK_THAT(live.err,
               Contains("warning: has run 2.0 s in the loop 0x0108..0x010a reading INTCON1, bit OSCFAIL"));
    const Ended json = bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "3", "--json"});
    const auto report = nlohmann::json::parse(json.out);
    CHECK(report["waiting"]["hung"] == true);
    CHECK(report["waiting"]["loop"] == nlohmann::json({"0x0108", "0x010a"}));
    CHECK(report["warnings"].size() == 1);
}

TEST_CASE("run names the robot that hangs, in both placements alike", "[hung]") {
    const Workbench bench;
    const std::string file = scenario(bench, image(bench, "bgst", kWaitsForReference));
    const std::string line =
        "warning: robot0.pic: has run 2.0 s in the loop 0x0108..0x010a reading INTCON1, bit "
        "OSCFAIL, which no model drives\n";
    for (const Words& arguments : {Words{file}, Words{file, "--in-process"}}) {
        const Ended ended = bench.run("o", arguments);
        CHECK(ended.status == 1);
        CHECK_THAT(ended.err, Contains("puckloop: node robot0.pic: has run 2.0 s in the loop"));
        CHECK_THAT(ended.out, Contains(line));
        CHECK(bench.report("o")["nodes"]["robot0.pic"]["waiting"]["hung"] == true);
    }
    const Ended strict = bench.run("o", {file, "--strict"});
    CHECK(strict.status == 1);
    CHECK_THAT(strict.err, Contains("robot0.pic: has run 2.0 s"));
    CHECK(bench.report("o")["success"] == false);
}

TEST_CASE("a robot that waits for a character is in order, a register without a model is not", "[hung]") {
    const Workbench bench;
    const std::string file = scenario(bench, image(bench, "idle", kWaitsForCharacter));
    const Ended ended = bench.run("o", {file});
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, !Contains("has run"));
    CHECK_THAT(ended.out, Contains("warning: robot0.pic: wrote BSRAM, which is not modelled, at pc 0x0106"));
    CHECK(bench.run("o", {file, "--strict"}).status == 1);
    const auto waiting = bench.report("o")["nodes"]["robot0.pic"]["waiting"];
    CHECK(waiting["hung"] == false);
    CHECK_THAT(waiting["text"].get<std::string>(), Contains("reading U2STA, bit URXDA"));
}

TEST_CASE("an address that nobody acknowledges is a warning, of a main board too", "[hung]") {
    const Workbench bench;
    const std::string hex = image(bench, "asks", kAsksNobody);
    const std::string line = "addressed 0x33 on I2C once, and nobody acknowledged";
    const Ended run = bench.run("o", {scenario(bench, hex)});
    CHECK(run.status == 0);
    CHECK_THAT(run.out, Contains("warning: robot0.pic: " + line));
    const Ended exec = bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "1"});
    CHECK_THAT(exec.out, Contains("warning: " + line));
    CHECK(bench.puckloop({"exec", "--board", "pic", hex, "--seconds", "1", "--strict"}).status == 1);
}

TEST_CASE("the project's own firmware gives no warning and passes --strict", "[hung]") {
    const Workbench bench;
    const Ended ended = bench.puckloop({"exec", "--board", "pic", PUCKLOOP_SOURCE "/firmware/epuck/epuck.hex",
                                        "--seconds", "5", "--strict"});
    CHECK(ended.status == 0);
    CHECK_THAT(ended.out, !Contains("warning"));
}

TEST_CASE("the demo that waits for a camera names the routines that would end it", "[hung]") {
    const auto demo = outside("PUCKLOOP_IMAGES", "demoGCtronic-rev117+bootloader.hex");
    if (!demo) {
        WARN("without PUCKLOOP_IMAGES the original firmware is not tried");
        return;
    }
    const Workbench bench;
    const Ended camera = bench.puckloop({"exec", "--board", "pic", demo->string(), "--selector", "6",
                                         "--seconds", "6", "--camera-model", "none"});
    CHECK_THAT(camera.out,
               Contains("in the loop 0x12756..0x1275c reading RAM 0x1fb2, which only the routine of "
                        "T4 writes, and T4 is off"));
    CHECK_THAT(camera.out, Contains("counts pin RC4 (camera_vsync), on which nothing changes"));
    for (const char* works : {"0", "1", "2", "4", "6", "15"}) {
        const Ended ended =
            bench.puckloop({"exec", "--board", "pic", demo->string(), "--selector", works, "--seconds", "6"});
        CHECK_THAT(ended.out, !Contains("has run"));
    }
}

TEST_CASE("a robot that crashes into resets, or traps, is in the warnings", "[hung]") {
    const Workbench bench;
    // An undefined instruction resets; a word at an odd address is a trap, whose routine returns.
    const std::string illegal =
        image(bench, "illegal", std::string(kMain) + "        .pword 0x3fffff, 0xff0000\n");
    const Ended crashed = bench.puckloop({"exec", "--board", "pic", illegal, "--seconds", "0.1"});
    CHECK_THAT(crashed.out,
               Contains("warning: crashed into a reset (IOPUWR) ") && Contains(", first at pc 0x0"));
    const std::string odd =
        image(bench, "odd",
              "        goto main\n        .org 0x0008\n        .pword trap\n" + std::string(kMain) + R"(
        mov     #0x0901, w1
        mov     [w1], w0
        mov     #0x8000, w0
        mov     w0, U2MODE
wait:   btss    U2STA, #0
        bra     wait
        bra     wait
trap:   bclr    INTCON1, #3
        retfie
)");
    const Ended trapped = bench.puckloop({"exec", "--board", "pic", odd, "--seconds", "0.1", "--strict"});
    CHECK(trapped.status == 1);
    CHECK_THAT(trapped.out, Contains("warning: took the AddressError trap once, first at pc 0x0"));
}
