// A run of real boards, exported: sigrok-cli and tshark read what the trace holds, byte for byte.

#include "foreign_tools.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <set>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

TEST_CASE("sigrok and tshark agree with the trace of two robots with range-and-bearing boards") {
    const std::string out = scratch("pair");
    const Called run = tests::puckloop(
        fmt::format("run {}/scenarios/rab_pair.toml --duration 0.6 --trace-format pcapng --out {}",
                    PUCKLOOP_SOURCE, out));
    INFO(run.out);
    REQUIRE(run.status == 0);
    for (const char* format : {"sr", "vcd"}) {
        const Called done = tests::puckloop(fmt::format("trace export {0} -o {0}/trace.{1}", out, format));
        INFO(done.out);
        REQUIRE(done.status == 0);
    }
    // The same as the run itself wrote.
    REQUIRE(tests::puckloop(fmt::format("trace export {0} -o {0}/again.pcapng", out)).status == 0);
    CHECK(shell(fmt::format("cmp {0}/trace.pcapng {0}/again.pcapng", out)).status == 0);
    const std::vector<TraceRow> rows = rows_of(out + "/trace.csv");
    std::map<std::string, std::vector<unsigned>> uart;
    for (const TraceRow& row : rows)
        if (const auto* frame = std::get_if<UartFrame>(&row.payload))
            uart[row.link + "/" + row.from].push_back(frame->data);
    REQUIRE(uart.size() == 4);
    const auto words = i2c_words(rows, "leader.i2c.linux");
    REQUIRE(words.size() > 500);
    if (installed("sigrok-cli")) {
        for (const auto& [line, bytes] : uart) {
            INFO(line);
            CHECK(sigrok_uart(out + "/trace.sr", line, 115200) == bytes);
        }
        CHECK(sigrok_i2c(out + "/trace.sr", "leader.i2c") == words);
        CHECK(sigrok_i2c(out + "/trace.sr", "follower.i2c") == i2c_words(rows, "follower.i2c.linux"));
        // The value change dump as it is, by the same names; sigrok warns of each text in it.
        const Called starts = shell(fmt::format("timeout 60 sigrok-cli -I vcd -i {}/trace.vcd -P "
                                                "i2c:scl=leader.i2c/scl:sda=leader.i2c/sda "
                                                "-A i2c=start:repeat-start 2>/dev/null",
                                                out));
        CHECK(lines_of(starts.out).size() ==
              static_cast<std::size_t>(std::count(words.begin(), words.end(), "S")));
    }
    if (installed("tshark"))
        for (const auto& [line, bytes] : uart) {
            std::string hex, read;
            for (const unsigned byte : bytes)
                hex += fmt::format("{:02x}", byte);
            std::string name = line;
            name.replace(name.find('/'), 1, " ");
            for (const std::string& packet : tests::tshark(
                     out + "/trace.pcapng", "frame.interface_name == \"" + name + "\"", "-e data.data"))
                read += packet;
            CHECK(read == hex);
        }
}
