// The board's two UARTs: range-and-bearing fact sheet 2.5, 1.5, 4.8 Q10.

#include "protocols/infrared/rab_frame.h"
#include "tests/rab_board/rab_rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using protocols::encode_rab;
using rab::RabRig;
using Bytes = std::vector<std::uint8_t>;

TEST_CASE("the UARTs run at 59593 baud") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.run_to(0.015);
    const auto text = rig.bench().take(2);
    REQUIRE(text.size() > 20);
    // Characters follow each other without a gap: ten bits of 688 cycles.
    const double between = cosim::to_seconds(text[20].start - text[10].start) / 10;
    CHECK(between == Approx(10 * 688 / 41e6).epsilon(0.005));
}

TEST_CASE("with register 18 set, messages leave by UART1 as twelve bytes, and polls find none") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.boot();
    rig.write(18, {1});
    rig.show(rig.now_s() + 0.001, encode_rab(16, 0xBEEF), {{0, 1500}, {1, 800}, {11, 900}});
    rig.run_for(0.02);
    const Bytes bytes = rig.bench().take_bytes(1);
    // Data, bearing as a 32-bit float (0.2648 rad), range 1561, peak 1500.
    REQUIRE(bytes.size() == 12);
    CHECK(Bytes(bytes.begin(), bytes.begin() + 4) == Bytes{0xEF, 0xBE, 0x00, 0x00});
    CHECK(Bytes(bytes.begin() + 6, bytes.end()) == Bytes{0x87, 0x3E, 0x19, 0x06, 0xDC, 0x05});
    CHECK(rig.get(0) == 0);
}

TEST_CASE("four hexadecimal digits on UART2 are sent on all emitters") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.boot();
    rig.bench().send(2, {'A', '5', 'c', '3'});
    rig.run_for(0.03);
    REQUIRE(rig.bursts(7).size() == 1);
    CHECK(rig.bursts(7)[0].chips == rab::visible(encode_rab(16, 0xA5C3)));
    CHECK_THAT(rig.bench().take_text(2), Catch::Contains("Received: a5c3\n\r"));
    // The sheet states that any other character clears the entry. It does not: it becomes the digit -1 (SETM
    // at 0x20C0), and only digits above 15 clear (BRA GT at 0x20C8, signed). 1, 2, -1, 1 add up to 0x11F1.
    rig.bench().send(2, {'1', '2', 'x', '1'});
    rig.run_for(0.03);
    CHECK_THAT(rig.bench().take_text(2), Catch::Contains("Received: 11f1\n\r"));
}

TEST_CASE("three bytes on UART1 are a command: all emitters send") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    RabRig rig(*file);
    rig.boot();
    rig.bench().send(1, {14, 0x0B, 0x9B});
    rig.run_for(0.02);
    REQUIRE(rig.bursts().size() == 1);
    CHECK(rig.bursts()[0].chips == rab::visible(encode_rab(16, 0x0B9B)));
}
