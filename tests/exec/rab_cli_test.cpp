// `puckloop exec --board rab` and scripted bus masters, as a user runs them.

#include "base/json.h"
#include "emu/dspic/devices/device.h"
#include "tests/exec/command.h"
#include "tests/exec/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using Catch::Contains;
using exec::Outcome;
using exec::text_of;
using exec::Workbench;

namespace {

/// I2C slave at 0x20 whose every register reads 0x5A, and which never lets go of SCL once 0xEE was written to
/// it. All emitters are on, with carrier, and the first peak detector is reset, when UART2 has said "hi".
std::string slave_image(const Workbench& bench) {
    constexpr std::string_view kSource = R"(
        goto main
        .org 0x0034
        .pword slave
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9040, w0
        mov w0, I2C1CON
        bset IEC1, #0
        mov #3, w0
        mov w0, U2BRG
        bset U2MODE, #15
        bset U2STA, #10
        mov #0x68, w0
        mov w0, U2TXREG
        mov #0x69, w0
        mov w0, U2TXREG
sent:   btss U2STA, #8
        bra sent
        clr LATB
        clr TRISB
        setm LATB
        mov #0xEFFE, w0
        mov w0, TRISF
        mov #0x1001, w0
        mov w0, LATF
        mov #84, w0
        mov w0, PR2
        mov #42, w0
        mov w0, OC1R
        mov w0, OC1RS
        mov #6, w0
        mov w0, OC1CON
        bset T2CON, #15
wait:   bra wait

slave:  bclr IFS1, #0
        mov I2C1RCV, w1
        btsc I2C1STAT, #2
        bra send
        mov #0xEE, w2
        sub w1, w2, w2
        bra z, hold
        bset I2C1CON, #12
hold:   retfie
send:   mov #0x5A, w2
        mov w2, I2C1TRN
        bset I2C1CON, #12
        retfie
)";
    return bench.image("slave.hex", exec::assembled(kSource, dspic::dspic33fj256gp710()));
}

}  // namespace

TEST_CASE("the range-and-bearing board lies on the bench: text, emitters, log") {
    const Workbench bench;
    const std::string image = slave_image(bench);
    const Outcome run =
        bench.run("--board rab " + image + " --uart2 - --seconds 0.02 --log " + bench.folder + "/log");
    CHECK(run.status == 0);
    CHECK(run.out == "hi");
    const std::string pins = text_of(bench.folder + "/log/pins.csv");
    for (const char* row : {",,emitter1,1\n", ",,emitter12,1\n", ",RF0,peak_reset1,1\n", ",,carrier,433"})
        CHECK_THAT(pins, Contains(row));
    CHECK_THAT(text_of(bench.folder + "/log/board.log"), Contains("carrier on, 43.4 kHz\n"));
    CHECK_THAT(bench.run("--board rab --list-signals").out,
               Contains("demod12") && Contains("peak1 ") && Contains("emitter7"));
}

TEST_CASE("a script of the bus's master is played, what nobody answers is reported") {
    const Workbench bench;
    const std::string image = slave_image(bench);
    const std::string script = bench.file("m.txt", "0.005 r 0x20 7 2\n"
                                                   "0.010 w 0x21 01 02\n"
                                                   "0.015 w 0x20 15 07\n");
    for (const char* target : {"--board rab ", "--mcu dspic33fj256gp710 "}) {
        INFO(target);
        const Outcome run = bench.run(target + image + " --seconds 0.02 --json --i2c script:" + script +
                                      " --log " + bench.folder + "/log");
        CHECK(run.status == 0);
        const auto json = nlohmann::json::parse(run.out);
        CHECK(json["i2c_script"]["played"] == 3);
        CHECK(json["i2c_script"]["addresses_refused"] == 1);
        CHECK(json["i2c_script"]["first_refused_line"] == 2);
        REQUIRE(json["i2c_script"]["reads"].size() == 1);
        CHECK(json["i2c_script"]["reads"][0]["bytes"] == "5a 5a");
        CHECK_FALSE(json["i2c_script"].contains("bus_stuck"));
        const std::string i2c = text_of(bench.folder + "/log/i2c.csv");
        for (const char* row :
             {"0.005000000,1,start,40,1,100000,", ",1,read,5a,1,100000,", ",1,read,5a,0,100000,",
              "0.010000000,1,start,42,0,100000,", "0.015000000,1,start,40,1,100000,", ",1,stop,00,0,100000,"})
            CHECK_THAT(i2c, Contains(row));
        if (json.contains("board")) CHECK(json["board"]["i2c"]["bad_payload_sizes"] == 1);
    }
    CHECK_THAT(text_of(bench.folder + "/log/board.log"), Contains("payload size 7 asked for"));
    const Outcome fast = bench.run("--board rab " + image +
                                   " --seconds 0.02 --json --i2c-clock 400000 --i2c-no-restart "
                                   "--i2c script:" +
                                   script + " --log " + bench.folder + "/log");
    CHECK(nlohmann::json::parse(fast.out)["i2c_script"]["starts"] == 4);
    CHECK_THAT(text_of(bench.folder + "/log/i2c.csv"), Contains("start,41,1,400000,"));
}

TEST_CASE("a slave that holds SCL for ever fails the run and is named") {
    const Workbench bench;
    const std::string image = slave_image(bench);
    const std::string script = bench.file("m.txt", "0.005 w 0x20 ee 00\n0.2 w 0x20 00 00\n");
    const std::string arguments = "--board rab " + image + " --seconds 0.3 --i2c script:" + script;
    const Outcome text = bench.run(arguments + " --log " + bench.folder + "/log");
    CHECK(text.status == 1);
    CHECK_THAT(text.out, Contains("i2c: bus stuck since 0.005090 s, line 1 of the script"));
    CHECK_THAT(text_of(bench.folder + "/log/i2c.csv"), Contains("0.005090000,1,bus lost,ee,0,100000,0.1"));
    const auto json = nlohmann::json::parse(bench.run(arguments + " --json").out);
    CHECK(json["success"] == false);
    CHECK(json["i2c_script"]["bus_stuck"]["line"] == 1);
    CHECK(json["i2c_script"]["played"] == 0);
}

TEST_CASE("a selector belongs to the main board alone") {
    const Workbench bench;
    const Outcome run = bench.run("--board rab " + slave_image(bench) + " --selector 3");
    CHECK(run.status == 2);
    CHECK_THAT(run.out + run.err, Contains("--selector: rab has no selector (expected --board pic)"));
}

TEST_CASE("the real board's first line: a script reads its registers") {
    const auto image = exec::real_image("randb.hex");
    if (!image) return;
    const Workbench bench;
    const std::string script = bench.file("m.txt", "0.1 w 0x20 0e 34\n0.12 r 0x20 0 1\n");
    const Outcome run =
        bench.run("--board rab " + *image + " --seconds 0.13 --json --uart2 - --i2c script:" + script);
    CHECK(run.status == 0);
    CHECK_THAT(run.out, Contains("E-PUCK RANGE AND BEARING STARTED\n\r0 0 0 0 0 0 0 0 0 0 0 0 \n\r"));
    const auto json = nlohmann::json::parse(run.out.substr(run.out.rfind("\n{") + 1));
    CHECK(json["board"]["emission"]["frames"] == 1);
    CHECK(json["i2c_script"]["reads"][0]["bytes"] == "00");
}
