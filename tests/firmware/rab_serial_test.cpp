// The project's own range-and-bearing firmware: its two UARTs.

#include "protocols/infrared/rab_frame.h"
#include "tests/firmware/rab_bench.h"

#include <catch2/catch.hpp>

#include <cstring>

using namespace puckloop;
using namespace puckloop::firmware;
using protocols::encode_rab;

namespace {

const std::string kImage = std::string(PUCKLOOP_FIRMWARE) + "/rab/rab.hex";
constexpr double kReady = 0.02;  // s

}  // namespace

TEST_CASE("own RAB firmware: messages over UART1: payload, bearing in rad, range, peak") {
    RabBench bench(kImage);
    bench.write(kReady, {18, 1});
    double time =
        bench.light(kReady + 0.001, encode_rab(16, 0xBEEF), levels({{0, 1500}, {1, 800}, {11, 900}}));
    time = bench.light(time + 0.005, encode_rab(16, 0x0102), levels({{7, 900}}));
    bench.read(time + 0.0015, 0);
    bench.run(time + 0.006);
    const auto bytes = bench.rig.take_bytes(1);
    REQUIRE(bytes.size() == 24);
    const auto number = [&](std::size_t at, int count) {
        std::uint32_t value = 0;
        for (int i = count - 1; i >= 0; --i)
            value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
        return value;
    };
    const auto real = [&](std::size_t at) {
        const std::uint32_t bits = number(at, 4);
        float value = 0;
        std::memcpy(&value, &bits, sizeof value);
        return value;
    };
    CHECK(number(0, 4) == 0xBEEF);
    CHECK(real(4) == Approx(0.2648).margin(0.003));
    CHECK(number(8, 2) == Approx(1561).margin(6));
    CHECK(number(10, 2) == Approx(1500).margin(4));
    CHECK(number(12, 4) == 0x0102);
    CHECK(real(16) == Approx(-2.3561).margin(0.0002));
    CHECK(bench.reads()[0][0] == 0);  // not left for I2C as well
}

TEST_CASE("own RAB firmware: commands over UART1: register, then as many bytes as the payload has") {
    for (const int size : {8, 16, 24, 32}) {
        RabBench bench(kImage);
        bench.write(kReady, {21, static_cast<std::uint8_t>(size)});
        bench.run(kReady + 0.001);
        const std::uint32_t payload = 0xDEADBEEF >> (32 - size);
        const auto command = [&](int number, std::uint32_t value) {
            std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(number)};
            for (int shift = size - 8; shift >= 0; shift -= 8)
                bytes.push_back(static_cast<std::uint8_t>(value >> shift));
            bench.rig.send(1, bytes);
            bench.rig.run_for(0.012);
        };
        command(14, payload);
        command(12, 77);
        CHECK(bench.rig.get("power") == 77);
        command(2, payload);
        command(15, 0);
        bench.rig.send(1, {14});  // stays incomplete
        bench.rig.run_for(0.03);
        command(14, 1);
        const auto third = bench.sent(3);
        REQUIRE(third.size() == 3);
        CHECK(third[0].chips == lit_part(encode_rab(size, payload)));
        CHECK(third[1].chips == lit_part(encode_rab(size, payload)));
        CHECK(third[2].chips == lit_part(encode_rab(size, 1)));
        CHECK(bench.sent(1).size() == 2);
    }
}

TEST_CASE("own RAB firmware: four hexadecimal digits from a PC are sent and printed") {
    RabBench bench(kImage);
    bench.run(0.06);
    bench.rig.take_text(2);
    bench.rig.send(2, {'1', '2', 'x', '0', '0', 'a', 'F'});
    bench.rig.run_for(0.02);
    CHECK(bench.rig.take_text(2) == "Received: af\n\r");
    const auto sent = bench.sent(1);
    REQUIRE(sent.size() == 1);
    CHECK(sent[0].chips == lit_part(encode_rab(16, 0x00AF)));
}
