// Devices on the bus of a target that is its master, and what is recorded of a bus with nobody on it.

#include "base/json.h"
#include "tests/exec/command.h"
#include "tests/kit/dspic_pieces.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using Catch::Contains;
using exec::one_line;
using exec::Outcome;
using exec::text_of;
using exec::Workbench;

namespace {

/// UART1 asks: a byte below 0x80 is an address of which register 1 is read and sent back; one above is 0x80 +
/// an address to which the nine bytes 1 to 9 are written.
std::string probe_image(const Workbench& bench) {
    const std::string source = tests::kMain + tests::kUart1 + R"(
        mov #150, w0
        mov w0, I2CBRG
        mov #0x8000, w0
        mov w0, I2CCON
wait:   btss U1STA, #0
        bra wait
        mov U1RXREG, w1
        mov #0x7f, w4
        and w1, w4, w2
        sl w2, #1, w2
        bset I2CCON, #0
begin:  btsc I2CCON, #0
        bra begin
        mov w2, w0
        rcall put
        btsc w1, #7
        bra many
        mov #1, w0
        rcall put
        bset I2CCON, #1
again:  btsc I2CCON, #1
        bra again
        ior w2, #1, w0
        rcall put
        bset I2CCON, #3
get:    btsc I2CCON, #3
        bra get
        mov I2CRCV, w3
        mov w3, U1TXREG
        bset I2CCON, #5
        bset I2CCON, #4
nack:   btsc I2CCON, #4
        bra nack
        bra stop
many:   clr w0
more:   inc w0, w0
        rcall put
        cp w0, #9
        bra nz, more
stop:   bset I2CCON, #2
stops:  btsc I2CCON, #2
        bra stops
        bra wait
put:    mov w0, I2CTRN
busy:   btsc I2CSTAT, #14
        bra busy
        return
)";
    return bench.image("probe.hex", exec::assembled(source));
}

/// Bytes that the board sent, hexadecimal.
std::string sent(const std::string& uart_csv) {
    std::string bytes;
    std::size_t at = 0;
    while ((at = uart_csv.find(",tx,", at)) != std::string::npos)
        bytes += (bytes.empty() ? "" : " ") + uart_csv.substr(at += 4, 2);
    return bytes;
}

}  // namespace

TEST_CASE("a read that nobody answers is recorded as the FF that the firmware gets") {
    const Workbench bench;
    const std::string image = probe_image(bench);
    const std::string script = bench.file("u.txt", "0.001 60\n");
    const Outcome run = bench.run("--board pic " + image + " --uart1 script:" + script + " --log " +
                                  bench.folder + "/log --seconds 0.01");
    CHECK(run.status == 0);
    CHECK(sent(text_of(bench.folder + "/log/uart1.csv")) == "ff");
    const std::string i2c = text_of(bench.folder + "/log/i2c.csv");
    CHECK_THAT(i2c, Contains(",1,start,c0,0,"));
    CHECK_THAT(i2c, Contains(",1,read,ff,"));
    CHECK_THAT(i2c, !Contains(",read,00,"));
}

TEST_CASE("the ground sensor on the bench's bus reads the stimulus") {
    const Workbench bench;
    const std::string image = probe_image(bench);
    const std::string script = bench.file("u.txt", "0.001 60\n0.01 60\n0.02 61\n");
    const std::string stimulus = bench.file("s.txt", "0.0005 ground0 0x\n");
    Outcome run = bench.run("--board pic " + image + " --i2c-device ground --stimulus " + stimulus);
    CHECK(run.status == 2);
    bench.file("s.txt", "0.0005 ground0 600\n0.005 ground0 700 # 0x2bc\n0.005 proximity0 10\n");
    for (const char* target : {"--board pic ", "--mcu dspic30f6014a "}) {
        if (target[2] == 'm') bench.file("s.txt", "0.0005 ground0 600\n0.005 ground0 700\n0.005 adc3 10\n");
        run = bench.run(target + image + " --i2c-device ground --stimulus " + stimulus + " --uart1 script:" +
                        script + " --log " + bench.folder + "/log --seconds 0.03 --json");
        REQUIRE(run.status == 0);
        CHECK(sent(text_of(bench.folder + "/log/uart1.csv")) == "58 bc ff");
        CHECK_THAT(text_of(bench.folder + "/log/i2c.csv"),
                   Contains(",1,start,c0,1,") && Contains(",1,read,58,") && Contains(",1,start,c2,0,"));
        CHECK_THAT(text_of(bench.folder + "/log/pins.csv"), Contains("0.005000000,,ground0,700"));
        const auto bus = nlohmann::json::parse(run.out)["i2c_bus"];
        CHECK(bus.at("bytes_read") == 3);  // the third from nobody
        CHECK(bus.at("devices").at("ground_sensor").at("registers_read") == 2);
    }
    // At another address.
    run =
        bench.run("--board pic " + image + " --i2c-device ground@0x61 --uart1 script:" + script + " --log " +
                  bench.folder + "/log --seconds 0.03 --stimulus " + bench.file("s2.txt", "0 ground0 600"));
    CHECK(sent(text_of(bench.folder + "/log/uart1.csv")) == "ff ff 58");
    CHECK_THAT(run.out, Contains("i2c: "));
}

TEST_CASE("the RGB turret on the bench's bus shows its colours as signals") {
    const Workbench bench;
    const std::string image = probe_image(bench);
    const std::string script = bench.file("u.txt", "0.001 e1\n");
    const Outcome run = bench.run("--board pic " + image + " --i2c-device turret --uart1 script:" + script +
                                  " --log " + bench.folder + "/log --seconds 0.01 --json");
    CHECK(run.status == 0);
    const std::string pins = text_of(bench.folder + "/log/pins.csv");
    for (const char* row : {",,rgb2_red,1\n", ",,rgb2_blue,3\n", ",,rgb0_red,7\n", ",,rgb0_blue,9\n"})
        CHECK_THAT(pins, Contains(row));
}

TEST_CASE("a range-and-bearing board runs its firmware on the bench's bus") {
    const Workbench bench;
    const std::string image = probe_image(bench);
    const std::string script = bench.file("u.txt", "0.02 20\n0.03 21\n");
    const std::string command = "--board pic " + image + " --i2c-device rab=" + PUCKLOOP_FIRMWARE +
                                "/rab/rab.hex --uart1 script:" + script + " --log " + bench.folder +
                                "/log --seconds 0.04 --json";
    const Outcome run = bench.run(command);
    REQUIRE(run.status == 0);
    const std::string i2c = text_of(bench.folder + "/log/i2c.csv");
    CHECK_THAT(i2c, Contains(",1,start,40,1,") && Contains(",1,start,41,1,"));  // its address
    CHECK_THAT(i2c, Contains(",1,start,42,0,"));                                // its neighbour's
    const auto json = nlohmann::json::parse(run.out);
    CHECK(json["i2c_bus"]["boards"]["rab"]["resets"][0]["cause"] == "POR");
    CHECK_THAT(text_of(bench.folder + "/log/rab.log"), Contains("end: "));
    // The same once more, to the byte.
    const std::string uart = text_of(bench.folder + "/log/uart1.csv");
    bench.run(command);
    CHECK(text_of(bench.folder + "/log/i2c.csv") == i2c);
    CHECK(text_of(bench.folder + "/log/uart1.csv") == uart);
}

TEST_CASE("devices that cannot be are refused with one line") {
    const Workbench bench;
    const std::string image = probe_image(bench);
    const auto refused = [&](const std::string& arguments, const char* text) {
        const Outcome run = bench.run(arguments + " " + image);
        INFO(arguments);
        CHECK(run.status == 2);
        CHECK(one_line(run.err));
        CHECK_THAT(run.err, Contains(text));
    };
    refused("--board pic --i2c-device grund", "did you mean ground?");
    refused("--board pic --i2c-device ground@20", "expected 0x08 to 0x77");
    refused("--board pic --i2c-device ground@0x78", "expected 0x08 to 0x77");
    refused("--board pic --i2c-device ground=a.hex", "has no firmware of its own");
    refused("--board pic --i2c-device rab", "rab=IMAGE");
    refused("--board pic --i2c-device rab=" + bench.folder + "/none.hex", "no such file");
    refused("--board pic --i2c-device rab=" + image, "another chip");
    refused("--board pic --i2c-device ground --i2c-device ground@0x61", "second of its kind");
    refused("--board pic --i2c-device ground --i2c-device turret@0x60", "second device at 0x60");
    refused("--board pic --i2c-device ground@0x61 --i2c-device turret", "second device at 0x61");
    refused("--board rab --i2c-device ground", "slave of its bus");
}
