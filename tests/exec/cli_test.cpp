// The built `puckloop exec`, as a user runs it: statuses, one-line errors, ends, JSON.

#include "base/json.h"
#include "tests/exec/command.h"
#include "tests/exec/rig.h"
#include "tests/kit/dspic_pieces.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>

using namespace puckloop;
using Catch::Contains;
using exec::one_line;
using exec::Outcome;
using exec::text_of;
using exec::Workbench;

namespace {

/// Echoes UART1 at 115200, each byte plus one; drives RD0 with what stands at RF1.
std::string echo_image(const Workbench& bench) {
    const std::string source = tests::kMain + tests::kUart1 + R"(
        clr LATD
        clr TRISD
wait:   btsc PORTF, #1
        bset LATD, #0
        btss PORTF, #1
        bclr LATD, #0
        btss U1STA, #0
        bra wait
echo:   mov U1RXREG, w0
        inc w0, w0
        mov w0, U1TXREG
        bra wait
)";
    return bench.image("echo.hex", exec::assembled(source));
}

}  // namespace

TEST_CASE("exec echoes bytes between standard input and output") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    const Outcome run = bench.run("--board pic " + image + " --uart1 - --seconds 3.2", "HAL");
    CHECK(run.status == 0);
    CHECK(run.out == "IBM");
    CHECK_THAT(run.err, Contains("stopped: budget") && Contains("reset: POR at 0.000000 s"));
    const Outcome early =
        bench.run("--mcu dspic30f6014a " + image + " --uart1 - --uart-start 0.001 --seconds 0.01", "HAL");
    CHECK(early.out == "IBM");
}

TEST_CASE("exec writes logs and JSON, and plays scripts and stimuli") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    const std::string script = bench.file("u1.txt", "0.001 41 42\n0.005 FF # wraps\n");
    const std::string stimulus = bench.file("s.txt", "0.002 battery_low 1\n0.004 battery_v 3.9\n");
    const Outcome run = bench.run("--board pic " + image + " --uart1 script:" + script + " --stimulus " +
                                  stimulus + " --log " + bench.folder + "/log --cycles 147456 --json");
    CHECK(run.status == 0);
    CHECK(run.err.empty());
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["stopped"] == "budget");
    CHECK(json["cycles"].get<double>() == Approx(147456).margin(3));
    CHECK(json["simulated_s"] == 0.01);
    CHECK(json["instructions"].get<int>() > 50000);
    CHECK(json["wall_s"].get<double>() > 0);
    CHECK(json["resets"][0]["cause"] == "POR");
    CHECK(json["traps"].empty());
    CHECK(json["unmodelled"].empty());
    CHECK(json["uart1"]["received"] == 3);
    const std::string uart = text_of(bench.folder + "/log/uart1.csv");
    CHECK_THAT(uart,
               Contains("0.001000000,rx,41,\n") && Contains(",tx,42,\n") && Contains("0.005000000,rx,ff,\n"));
    CHECK(std::count(uart.begin(), uart.end(), '\n') == 7);
    const std::string pins = text_of(bench.folder + "/log/pins.csv");
    CHECK_THAT(pins, Contains(",RD0,left_coil_a,1\n0.002000000,,battery_low,1\n0.002000") &&
                         Contains("0.004000000,,battery_v,3.9\n0.004000"));
    CHECK(text_of(bench.folder + "/log/uart2.csv") == "time_s,direction,byte,error\n");
}

TEST_CASE("exec's statuses: an address reached, a budget that ends first") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    Outcome run =
        bench.run("--mcu dspic30f6014a " + image + " --stop-at 0x200 --stop-at 0x100 --seconds 1 --json");
    CHECK(run.status == 0);
    auto json = nlohmann::json::parse(run.out);
    CHECK(json["stopped"] == "0x100");
    CHECK(json["pc"] == "0x0100");
    run = bench.run("--mcu dspic30f6014a " + image + " --stop-at 0x200 --seconds 0.01 --json");
    CHECK(run.status == 1);
    CHECK(nlohmann::json::parse(run.out)["stopped"] == "budget");
    CHECK(nlohmann::json::parse(run.out)["success"] == false);
}

TEST_CASE("a framing error is heard by the chip and by the bench, and logged") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    const std::string script = bench.file("u1.txt", "0.001 00\n");
    const Outcome run = bench.run("--board pic " + image + " --uart1 script:" + script +
                                  " --baud 76800 --log " + bench.folder + "/log --seconds 0.01 --json");
    CHECK(run.status == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["uart1"]["framing_errors"] == 1);
    CHECK_THAT(text_of(bench.folder + "/log/uart1.csv"), Contains(",rx,,framing\n"));
}

TEST_CASE("each UART's end has a baud rate of its own, and --baud is that of both") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    const std::string script = bench.file("u.txt", "0.001 41 42\n");
    const std::string both = "--board pic " + image + " --uart1 script:" + script +
                             " --uart2 script:" + script + " --log " + bench.folder +
                             "/log --seconds 0.01 --json";
    // The second byte follows ten bits after the first: 1.041 667 ms at 9600, 86.806 us at 115 200.
    const auto second = [&](int unit) {
        return text_of(bench.folder + "/log/uart" + std::to_string(unit) + ".csv");
    };
    Outcome run = bench.run(both + " --uart2-baud 9600");
    CHECK(run.status == 0);
    CHECK_THAT(second(1), Contains("0.001086806,rx,42,"));
    CHECK_THAT(second(2), Contains("0.002041667,rx,42,"));
    run = bench.run(both + " --baud 9600 --uart1-baud 115200");
    CHECK(nlohmann::json::parse(run.out)["uart1"]["framing_errors"] == 0);
    CHECK_THAT(second(1), Contains("0.001086806,rx,42,"));
    CHECK_THAT(second(2), Contains("0.002041667,rx,42,"));
    run = bench.run(both + " --uart1-baud 76800");
    CHECK_THAT(second(1), Contains("0.001130208,rx,42,"));
    CHECK_THAT(second(2), Contains("0.001086806,rx,42,"));
    run = bench.run(both + " --uart1-baud 3");
    CHECK(run.status == 2);
    CHECK_THAT(run.err, Contains("--uart1-baud"));
}

TEST_CASE("exec refuses what it cannot use with one line and status 2") {
    const Workbench bench;
    const std::string image = echo_image(bench);
    const std::string bad = bench.file("bad.txt", "0 w 0x20\n");
    const std::string master = bench.file("master.txt", "0 w 0x20 00\n");
    const std::string stimulus = bench.file("s.txt", "0 proximty0 1\n");
    const std::pair<std::string, const char*> cases[] = {
        {"--board pic", "IMAGE: missing"},
        {"--board nic " + image, "no board 'nic' (expected pic or rab or tam; did you mean pic?)"},
        {"--mcu dspic30f " + image, "no chip 'dspic30f'"},
        {"--board pic " + bench.folder + "/none.hex", "no such file"},
        {"--board pic " + bad, "expected"},
        {"--board pic " + image + " --uart1 serial", "-, pty, tcp:PORT or script:FILE"},
        {"--board pic " + image + " --uart2 script:" + bench.folder + "/none", "no such file"},
        {"--board pic " + image + " --uart2 script:" + master, "line 1: 'w' is not hexadecimal bytes"},
        {"--board pic " + image + " --uart1 - --uart2 -", "already at uart1"},
        {"--board pic " + image + " --i2c script:" + bad, "line 1: too short"},
        {"--board pic " + image + " --i2c " + master, "script:FILE"},
        {"--board pic " + image + " --stimulus " + stimulus, "did you mean proximity0?"},
        {"--board pic " + image + " --stop-at main", "no symbols"},
        {"--board pic " + image + " --stop-at 0x101", "not a program address"},
        {"--board pic " + image + " --fosc 1", "robot, image or 0xWORD"},
        {"--board pic " + image + " --log " + image, "cannot be made"},
    };
    for (const auto& [arguments, expected] : cases) {
        INFO(arguments);
        const Outcome run = bench.run(arguments);
        CHECK(run.status == 2);
        CHECK(run.out.empty());
        CHECK(one_line(run.err));
        CHECK_THAT(run.err, Contains(expected));
    }
    CHECK(bench.run("--board pic " + image + " --seconds -1").status == 2);
    CHECK(bench.run("--board pic --mcu dspic30f6014a " + image).status == 2);
}

TEST_CASE("exec lists the signals of boards and chips") {
    const Workbench bench;
    const Outcome text = bench.run("--board pic --list-signals");
    CHECK(text.status == 0);
    CHECK_THAT(text.out, Contains("proximity0") && Contains("counts") && Contains("battery_v"));
    const auto json = nlohmann::json::parse(bench.run("--mcu dspic30f6014a --list-signals --json").out);
    CHECK(json[8]["name"] == "adc8");
    CHECK(json[8]["unit"] == "counts");
    CHECK(json[json.size() - 2]["name"] == "RG15");
    CHECK(json.back()["name"] == "vdd");
    CHECK(json.back()["unit"] == "V");
}

TEST_CASE("a newcomer's first line: BTcom prints its greeting and its version") {
    const auto image = exec::real_image("BTcom_default.hex");
    if (!image) return;
    const Workbench bench;
    const Outcome run = bench.run("--board pic " + *image + " --uart1 - --seconds 8", "V\r");
    CHECK(run.status == 0);
    CHECK(run.out == "\x0C\x07WELCOME to the SerCom protocol on e-Puck\r\n"
                     "the EPFL education robot type \"H\" for help\r\nv,Version 1.1.4 December 2006\r\n");
}

TEST_CASE("symbols of a real ELF are stop addresses") {
    const auto image = exec::real_image("demoGCtronic.X.production.elf");
    if (!image) return;
    const Workbench bench;
    const Outcome run = bench.run("--board pic " + *image + " --stop-at main --seconds 1 --json");
    CHECK(run.status == 0);
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["stopped"] == "main");
    CHECK(json["pc"] == "0x1015c");
}
