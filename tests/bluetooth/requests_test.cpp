// Requests about the module itself, and everything that is wrong with a request.

#include "base/random.h"
#include "tests/bluetooth/host.h"

using namespace puckloop;
using namespace puckloop::bluetooth;
using namespace puckloop::bluetooth::test;

TEST_CASE("a module sends READY, and again after a reset", "[bluetooth]") {
    Air air(robots(1));
    air.run(2 * cosim::kSecond, 7 * kMs);
    REQUIRE(air.packets(0).size() == 1);
    const Air::Said ready = air.lines[0].said[0];
    CHECK(ready.packet == LmxPacket{protocols::kLmxIndication, 0x25, {4, '0', '6', '1', '8'}});
    // 500 ms of boot, and the packet's octets.
    CHECK(ready.at >= 500 * kMs);
    CHECK(ready.at < 500 * kMs + 13 * 10 * kBit);
    // The version has four digits at most: the e-puck library keeps no more.
    air.request(0, 0x26);
    air.run(2 * cosim::kSecond, 3 * kMs);
    REQUIRE(air.packets(0).size() == 2);
    CHECK(air.packets(0)[1] == ready.packet);
    CHECK(air.report()["modules"]["r0"]["resets"] == 1);
}

TEST_CASE("a module keeps what it is set to", "[bluetooth]") {
    Air air(robots(1));
    air.boot();
    // As delivered: the null octet counts, which the e-puck library needs.
    CHECK(air.ask(0, 0x03) == Bytes{0, 12, 'e', '-', 'p', 'u', 'c', 'k', '_', '0', '0', '0', '1', 0});
    CHECK(air.ask(0, 0x16) == Bytes{0, 4, '0', '0', '0', '1'});
    CHECK(air.ask(0, 0x05) == with({0}, address_of(0)));
    CHECK(air.ask(0, 0x1C) == Bytes{0, 0});
    CHECK(air.ask(0, 0x4F) == Bytes{0, 1});
    RandomStream random(30, "values");
    for (int round = 0; round < 20; ++round) {
        Bytes name{static_cast<std::uint8_t>(2 + random.below(38))};
        for (int i = 1; i < name[0]; ++i)
            name.push_back(static_cast<std::uint8_t>('a' + random.below(26)));
        name.push_back(0);
        CHECK(air.ask(0, 0x04, name) == Bytes{0});
        Bytes expected{0};
        expected.insert(expected.end(), name.begin(), name.end());
        CHECK(air.ask(0, 0x03) == expected);
        Bytes pin{static_cast<std::uint8_t>(1 + random.below(16))};
        for (int i = 0; i < pin[0]; ++i)
            pin.push_back(static_cast<std::uint8_t>('0' + random.below(10)));
        CHECK(air.ask(0, 0x17, pin) == Bytes{0});
        expected = {0};
        expected.insert(expected.end(), pin.begin(), pin.end());
        CHECK(air.ask(0, 0x16) == expected);
        const auto word = static_cast<std::uint16_t>(random.next());
        const auto low = static_cast<std::uint8_t>(word), high = static_cast<std::uint8_t>(word >> 8);
        CHECK(air.ask(0, 0x55, {low, high}) == Bytes{0});
        CHECK(air.ask(0, 0x56) == Bytes{0, low, high});
        CHECK(air.ask(0, 0x22, {low, high, 0, 0}) == Bytes{0});
        CHECK(air.ask(0, 0x1F) == Bytes{0, low, high, 0, 0});
        const auto mode = static_cast<std::uint8_t>(1 + random.below(3));
        CHECK(air.ask(0, 0x19, {mode}) == Bytes{0});
        CHECK(air.ask(0, 0x18) == Bytes{0, mode});
    }
    // Factory settings: the address stays.
    CHECK(air.ask(0, 0x1A) == Bytes{0});
    CHECK(air.ask(0, 0x16) == Bytes{0, 4, '0', '0', '0', '0'});
    CHECK(air.ask(0, 0x05) == with({0}, address_of(0)));
    CHECK(air.ask(0, 0x03)[1] == 19);
}

TEST_CASE("requests that are wrong are answered with their error", "[bluetooth]") {
    Air air(robots(1));
    air.boot();
    struct Case {
        std::uint8_t opcode;
        Bytes data;
        std::uint8_t error;
    };
    Bytes long_name(42, 'x'), long_pin(18, '1');
    long_name[0] = 41;
    long_pin[0] = 17;
    const std::vector<Case> cases{
        {0x00, {5, 10}, 0x01},
        {0x00, {0, 10, 0}, 0x02},
        {0x00, {0x31, 10, 0}, 0x02},
        {0x00, {5, 10, 2}, 0x03},
        {0x03, {1}, 0x01},
        {0x04, {3, 'a'}, 0x01},
        {0x04, long_name, 0x06},
        {0x17, long_pin, 0x2E},
        {0x06, {2, 0}, 0x08},
        {0x06, {1, 3}, 0x07},
        {0x19, {0}, 0x09},
        {0x19, {4}, 0x09},
        {0x1B, Bytes(6, 9), 0x0A},
        {0x23, {11}, 0x11},
        {0x48, {11, 0, 1}, 0x11},
        {0x48, {7, 3, 1}, 0x2F},
        {0x48, {7, 0, 3}, 0x30},
        {0x4A, {2}, 0x03},
        {0x4E, {4}, 0x03},
        {0x4C, {0x10, 0}, 0x2D},
        {0x0A, {1}, 0x01},
        {0x0A, with({0}, address_of(3), {1}), 0x20},
        {0x0A, with({1}, address_of(3), {31}), 0x20},
        {0x0D, {1}, 0x1F},
        {0x0F, {1, 1, 0, 'x'}, 0x1F},
        {0x0F, {1, 2, 0, 'x'}, 0x01},
        {0x11, {1}, 0x1F},
        {0x12, {0}, 0x25},
        {0x15, {0}, 0x25},
        {0x20, Bytes(6, 9), 0x1F},
        {0x35, {}, 0x27},
    };
    for (const Case& one : cases) {
        INFO(protocols::lmx_opcode_name(one.opcode) << ' ' << one.data.size());
        CHECK(air.ask(0, one.opcode, one.data).at(0) == one.error);
    }
    const auto report = air.report();
    CHECK(report["modules"]["r0"]["not_modelled"] == nlohmann::json{{"SDAP_SERVICE_BROWSE", 1}});
    REQUIRE(report["warnings"].size() == 1);
    CHECK(report["warnings"][0] == "r0: the Bluetooth module does not model SDAP_SERVICE_BROWSE");
}

TEST_CASE("what is no request is dropped, counted, and keeps nobody waiting", "[bluetooth]") {
    Air air(robots(1));
    // Before it is up nothing is heard.
    air.request(0, 0x03);
    air.boot();
    air.request(0, 0x7f);
    air.say(0, protocols::encode_lmx({protocols::kLmxConfirm, 0x03, {}}));
    Bytes bad = protocols::encode_lmx({protocols::kLmxRequest, 0x03, {}});
    bad[5] ^= 1;
    air.say(0, bad);
    bad[5] ^= 1;
    bad[6] = 4;
    air.say(0, bad);
    air.say_text(0, "hello");
    air.say_break(0);
    air.run(100 * kMs);
    CHECK(air.packets(0).empty());
    CHECK(air.ask(0, 0x16).size() == 6);
    const auto counts = air.report()["modules"]["r0"];
    CHECK(counts["while_down"] == 7);
    CHECK(counts["not_modelled"]["0x7f"] == 1);
    CHECK(counts["bad_packets"] == nlohmann::json{{"no request", 1}, {"bad check", 1}, {"no end octet", 1}});
    // The damaged packet's last octet and the word.
    CHECK(counts["between_packets"] == 6);
}

TEST_CASE("any octets leave a module that answers", "[bluetooth]") {
    RandomStream random(31, "fuzz");
    Air air(robots(2));
    air.boot();
    for (int round = 0; round < 400; ++round) {
        // Requests with any data: most of them with a known opcode, some changing the module for good.
        const auto opcode = static_cast<std::uint8_t>(random.below(0x5A));
        Bytes data(random.below(11));
        for (std::uint8_t& octet : data)
            octet = static_cast<std::uint8_t>(random.below(random.below(2) == 0 ? 4 : 256));
        Bytes octets = protocols::encode_lmx({protocols::kLmxRequest, opcode, data});
        if (random.below(4) == 0) octets[random.below(octets.size())] ^= 0x10;
        // The serial line's settings stay, so that the host is understood.
        if (opcode == 0x23 || opcode == 0x48) continue;
        air.say(0, octets);
        air.run(static_cast<Time>(random.below(80)) * kMs, 11 * kMs);
    }
    air.run(80 * cosim::kSecond, 500 * kMs);
    air.say(0, Bytes(400, 0xFF));
    air.request(0, 0x4E, {0});
    air.request(0, 0x26);
    air.run(3 * cosim::kSecond);
    REQUIRE(!air.packets(0).empty());
    CHECK(air.packets(0).back().opcode == 0x25);
}

TEST_CASE("the serial line changes its speed after the confirm, or with the next reset", "[bluetooth]") {
    Air air(robots(1));
    air.boot();
    CHECK(air.ask(0, 0x48, {8, 2, 1}) == Bytes{0});
    // At the old speed it is not understood any more.
    air.request(0, 0x16);
    air.run(100 * kMs);
    CHECK(air.packets(0).size() == 1);
    CHECK(air.node.module(0).line().speed == 8);
    CHECK(air.node.module(0).line().parity == 2);
    // NVS speed: not before the reset.
    Air other(robots(1));
    other.boot();
    CHECK(other.ask(0, 0x23, {3}) == Bytes{0});
    CHECK(other.ask(0, 0x16)[0] == 0);
    CHECK(other.node.module(0).line().speed == 7);
    other.request(0, 0x26);
    other.run(2 * cosim::kSecond);
    CHECK(other.node.module(0).line().speed == 3);
}
