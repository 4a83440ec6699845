// Traces drawn at random, exported, and read by sigrok-cli and tshark: they must find what was drawn.

#include "foreign_tools.h"

#include "protocols/serial/uart_sampling.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <random>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

constexpr Time kBit = kSecond / 115200;

struct Draw {
    std::mt19937 random{Catch::rngSeed()};
    unsigned below(unsigned n) { return static_cast<unsigned>(random() % n); }
};

std::string export_as(const std::string& trace, const std::string& format) {
    const std::string file = trace + "." + format;
    const Called called = puckloop::tests::puckloop(fmt::format("trace export {} -o {}", trace, file));
    INFO(called.out);
    REQUIRE(called.status == 0);
    return file;
}

}  // namespace

TEST_CASE("sigrok and tshark read every byte of a UART line, whatever the pauses and rates") {
    Draw draw;
    INFO("seed " << Catch::rngSeed());
    std::vector<TraceRow> rows;
    std::vector<unsigned> sent;
    std::string hex;
    Time now = kMillisecond;
    for (int i = 0; i < 300; ++i) {
        if (draw.below(5) == 0) now += draw.below(3'000'000) * kNanosecond;
        UartFrame frame{now, kBit + kBit / 100 * static_cast<Time>(draw.below(5)) - kBit / 50,
                        static_cast<std::uint16_t>(draw.below(256))};
        rows.push_back(uart_row("toy.uart", "left", frame));
        sent.push_back(frame.data);
        hex += fmt::format("{:02x}", frame.data);
        now = protocols::frame_end(frame) + draw.below(3) * kMicrosecond;
    }
    const std::string trace = write_trace("uart.csv", rows);
    const std::string sr = export_as(trace, "sr"), pcapng = export_as(trace, "pcapng");
    if (installed("sigrok-cli")) CHECK(sigrok_uart(sr, "toy.uart/left", 115200) == sent);
    if (installed("tshark")) {
        std::string read;
        for (const std::string& line : tests::tshark(pcapng, "rtacser", "-e data.data"))
            read += line;
        CHECK(read == hex);
        CHECK(tests::tshark(pcapng, "rtacser", "-e frame.interface_name").front() == "toy.uart left");
    }
}

TEST_CASE("sigrok and tshark find every wrong parity bit and every break, and no other error") {
    Draw draw;
    INFO("seed " << Catch::rngSeed());
    std::vector<TraceRow> rows;
    std::size_t wrong = 0, breaks = 0, faults = 0;
    Time now = kMillisecond;
    for (int i = 0; i < 120; ++i) {
        UartFrame frame{now, kBit, static_cast<std::uint16_t>(draw.below(256)), 8, 2, 1};
        const bool odd = __builtin_popcount(frame.data) % 2 != 0;
        const unsigned what = draw.below(8);
        frame.parity_bit = static_cast<std::uint8_t>(odd != (what == 0));
        frame.is_break = what == 1;
        wrong += what == 0 ? 1U : 0U;
        breaks += what == 1 ? 1U : 0U;
        faults += what == 2 ? 1U : 0U;
        rows.push_back(uart_row("toy.uart", "left", frame, what == 2 ? FaultKind::Drop : FaultKind::None));
        now = protocols::frame_end(frame) + 3 * kBit;
    }
    const std::string trace = write_trace("parity.csv", rows);
    const std::string sr = export_as(trace, "sr"), pcapng = export_as(trace, "pcapng");
    if (installed("sigrok-cli")) {
        const auto count = [&](const char* annotation) {
            return sigrok_uart_count(sr, "toy.uart/left", 115200, "even", annotation);
        };
        CHECK(sigrok_uart(sr, "toy.uart/left", 115200, "even").size() == rows.size() - faults);
        CHECK(count("rx-parity-err") == wrong);
        CHECK(count("rx-break") == breaks);
        CHECK(count("rx-warnings") == breaks);  // "Frame error": the stop bit of a break is low
    }
    if (installed("tshark")) {
        CHECK(tests::tshark(pcapng, "rtacser.eventtype == 8", "-e frame.number").size() == wrong);
        CHECK(tests::tshark(pcapng, "rtacser.eventtype == 9", "-e frame.number").size() == breaks);
        CHECK(tests::tshark(pcapng, "frame.comment contains \"fault: drop, not received\"", "-e frame.number")
                  .size() == faults);
    }
}

TEST_CASE("sigrok and tshark read every START, address, byte, acknowledge and STOP of an I2C bus") {
    Draw draw;
    INFO("seed " << Catch::rngSeed());
    std::vector<TraceRow> rows;
    I2cScript script(rows, 10 * kMicrosecond);
    std::vector<std::string> words, packets;
    const auto stretch = [&] { return draw.below(3) == 0 ? draw.below(40'000) * kNanosecond : Time{0}; };
    const auto bit = [&](bool acknowledged) { words.push_back(acknowledged ? "A" : "N"); };
    for (int transfer = 0; transfer < 60; ++transfer) {
        const unsigned parts = 1 + draw.below(3);
        for (unsigned part = 0; part < parts; ++part) {
            const unsigned address = 8 + draw.below(112);
            const bool reads = draw.below(2) != 0, there = draw.below(6) != 0;
            script.start(static_cast<std::uint8_t>(address << 1 | (reads ? 1 : 0)), there, stretch());
            words.insert(words.end(), {"S", fmt::format("a{:02X}", address)});
            bit(there);
            std::string packet = fmt::format("{:02x}", address << 1 | (reads ? 1U : 0U));
            const unsigned bytes = there ? draw.below(5) : 0;
            for (unsigned i = 0; i < bytes; ++i) {
                const auto byte = static_cast<std::uint8_t>(draw.below(256));
                const bool acknowledged = reads ? i + 1 < bytes : draw.below(8) != 0;
                reads ? script.read(byte, acknowledged, stretch())
                      : script.write(byte, acknowledged, stretch());
                words.push_back(fmt::format("{}{:02X}", reads ? 'R' : 'W', byte));
                bit(acknowledged);
                packet += fmt::format("{:02x}", byte);
            }
            packets.push_back(packet);
        }
        script.stop();
        words.push_back("P");
        script.pause(draw.below(2) == 0 ? Time{0} : draw.below(100) * kMicrosecond);
    }
    const std::string trace = write_trace("i2c.csv", rows);
    CHECK(i2c_words(rows, "toy.i2c.master") == words);
    const std::string sr = export_as(trace, "sr"), pcapng = export_as(trace, "pcapng");
    if (installed("sigrok-cli")) CHECK(sigrok_i2c(sr, "toy.i2c") == words);
    if (installed("tshark")) CHECK(tests::tshark(pcapng, "i2c", "-e data.data") == packets);
}
