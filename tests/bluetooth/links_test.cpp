// Inquiry, names, links, data, transparent mode, release, loss.

#include "base/random.h"
#include "tests/bluetooth/host.h"

using namespace puckloop;
using namespace puckloop::bluetooth;
using namespace puckloop::bluetooth::test;

namespace {

constexpr std::uint8_t kInd = protocols::kLmxIndication, kCfm = protocols::kLmxConfirm;

/// Everybody answers an inquiry at once.
AirSpec prompt(std::size_t count, std::uint64_t seed = 1) {
    AirSpec spec = robots(count, seed);
    spec.times.discovery = 0.2;
    return spec;
}

}  // namespace

TEST_CASE("an inquiry finds who is near and shows itself, and lasts as long as asked", "[bluetooth]") {
    Air air(prompt(5));
    air.place(3, 30.0, 0.0);  // beyond 10 m
    air.boot();
    CHECK(air.ask(2, 0x06, {1, 0}) == Bytes{0});  // connectable, not discoverable
    air.forget();
    const Time begin = air.now();
    air.request(0, 0x00, {5, 10, 0});
    air.run(10 * cosim::kSecond, 90 * kMs);
    auto said = air.packets(0);
    REQUIRE(said.size() == 3);
    std::vector<Address> found;
    for (std::size_t i = 0; i < 2; ++i) {
        CHECK(said[i].type == kInd);
        CHECK(said[i].opcode == 0x01);
        REQUIRE(said[i].data.size() == 9);
        Address address{};
        std::copy_n(said[i].data.begin(), 6, address.begin());
        found.push_back(address);
        CHECK(Bytes(said[i].data.begin() + 6, said[i].data.end()) == Bytes{0, 0, 0});
    }
    std::sort(found.begin(), found.end());
    CHECK(found == std::vector<Address>{address_of(1), address_of(4)});
    CHECK(said[2] == LmxPacket{kCfm, 0x00, {0}});
    // 5 x 1.28 s, then the last packet.
    const Time took = air.lines[0].said[2].at - begin;
    CHECK(took >= 6400 * kMs);
    CHECK(took < 6410 * kMs);
    // With a limit it is over at the first.
    air.forget();
    air.request(0, 0x00, {5, 1, 0});
    air.run(4 * cosim::kSecond);
    said = air.packets(0);
    REQUIRE(said.size() == 2);
    CHECK(said[0].opcode == 0x01);
    CHECK(said[1] == LmxPacket{kCfm, 0x00, {0}});
}

TEST_CASE("names are asked over the air, nobody at the address is a timeout", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    air.request(0, 0x02, with({}, address_of(1)));
    air.run(20 * cosim::kSecond);
    REQUIRE(air.packets(0).size() == 1);
    Bytes expected = with({0}, address_of(1), {11});
    for (const char c : std::string("e-puck_0002"))
        expected.push_back(static_cast<std::uint8_t>(c));
    CHECK(air.packets(0)[0] == LmxPacket{kCfm, 0x02, expected});
    air.forget();
    const Time begin = air.now();
    air.request(0, 0x02, with({}, address_of(7)));
    air.run(20 * cosim::kSecond);
    REQUIRE(air.packets(0).size() == 1);
    CHECK(air.packets(0)[0].data == with({4}, address_of(7), {0}));
    CHECK(air.lines[0].said[0].at - begin > 5120 * kMs);
    CHECK(air.lines[0].said[0].at - begin < 5130 * kMs);
}

TEST_CASE("two robots link, talk both ways, and part", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    // The PIN of the other, as the e-puck library does.
    CHECK(air.ask(0, 0x17, {4, '0', '0', '0', '2'}) == Bytes{0});
    air.forget();
    air.request(0, 0x0A, with({1}, address_of(1), {1}));
    air.run(60 * cosim::kSecond, 333 * kMs);
    CHECK(air.packets(0) ==
          std::vector<LmxPacket>{{kCfm, 0x0A, {0, 1}}, {kInd, 0x0B, with({0}, address_of(1), {1, 1})}});
    CHECK(air.packets(1) == std::vector<LmxPacket>{{kInd, 0x0C, with({}, address_of(0), {1})}});
    CHECK(air.node.module(1).transparent());
    // Packets here, plain bytes there.
    air.forget();
    CHECK(air.ask(0, 0x0F, {1, 5, 0, 'h', 'e', 'l', 'l', 'o'}) == Bytes{0, 1});
    CHECK(air.lines[1].plain == Bytes{'h', 'e', 'l', 'l', 'o'});
    air.forget();
    air.say_text(1, "I hear you");
    air.run(100 * kMs);
    REQUIRE(!air.packets(0).empty());
    std::string heard;
    for (const LmxPacket& packet : air.packets(0)) {
        CHECK(packet.opcode == 0x10);
        REQUIRE(packet.data.size() > 3);
        CHECK(packet.data[0] == 1);
        CHECK(packet.data.size() == 3u + packet.data[1] + 256u * packet.data[2]);
        heard.append(packet.data.begin() + 3, packet.data.end());
    }
    CHECK(heard == "I hear you");
    // Transparent here too, and any octets come through as they are.
    air.forget();
    CHECK(air.ask(0, 0x11, {1}) == Bytes{0, 1});
    RandomStream random(40, "data");
    Bytes there(1500), back(1500);
    for (std::size_t i = 0; i < there.size(); ++i) {
        // No 02: the test's reader would take it for a packet.
        there[i] = static_cast<std::uint8_t>(3 + random.below(253));
        back[i] = static_cast<std::uint8_t>(3 + random.below(253));
    }
    air.forget();
    air.say(0, there);
    air.say(1, back);
    air.run(1 * cosim::kSecond, 17 * kMs);
    CHECK(air.lines[1].plain == there);
    CHECK(air.lines[0].plain == back);
    // A break ends it, and the link can be released.
    air.forget();
    air.say_break(0);
    air.run(50 * kMs);
    CHECK(air.packets(0) == std::vector<LmxPacket>{{kInd, 0x11, {1, 0}}});
    air.forget();
    air.request(0, 0x0D, {1});
    air.run(10 * cosim::kSecond);
    CHECK(air.packets(0) == std::vector<LmxPacket>{{kCfm, 0x0D, {0, 1}}, {kInd, 0x0E, {0, 1}}});
    CHECK(air.packets(1) == std::vector<LmxPacket>{{kInd, 0x0E, {1, 1}}, {kInd, 0x11, {1, 0}}});
    CHECK(air.lines[1].breaks == 1);
    CHECK(!air.node.module(1).transparent());
    // Both know each other now.
    CHECK(air.ask(0, 0x1C) == with({0, 1}, address_of(1)));
    CHECK(air.ask(1, 0x1C) == with({0, 1}, address_of(0)));
}

TEST_CASE("pairing needs the other's PIN once, keys last", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    const auto attempt = [&](std::size_t from, std::size_t to) {
        air.forget();
        air.request(from, 0x0A, with({1}, address_of(to), {1}));
        air.run(60 * cosim::kSecond);
        REQUIRE(air.packets(from).size() == 2);
        return air.packets(from)[1].data.at(0);
    };
    const auto release = [&](std::size_t from) {
        air.request(from, 0x0D, {1});
        air.run(10 * cosim::kSecond);
    };
    CHECK(attempt(0, 1) == kRfcommRejected);
    CHECK(air.packets(1).empty());
    air.ask(0, 0x17, {4, '0', '0', '0', '2'});
    CHECK(attempt(0, 1) == kRfcommOk);
    release(0);
    air.ask(0, 0x17, {4, '0', '0', '0', '1'});
    CHECK(attempt(1, 0) == kRfcommOk);
    release(1);
    CHECK(air.ask(1, 0x1B, with({}, address_of(0))) == Bytes{0});
    CHECK(attempt(0, 1) == kRfcommRejected);
    // Without security nobody asks.
    air.ask(0, 0x19, {1});
    air.ask(1, 0x19, {1});
    CHECK(attempt(0, 1) == kRfcommOk);
}

TEST_CASE("links that cannot be had fail with their reason", "[bluetooth]") {
    Air air(robots(4));
    air.boot();
    const auto attempt = [&](std::size_t from, std::size_t to, std::uint8_t remote_port = 1) {
        air.ask(from, 0x17, {4, '0', '0', '0', static_cast<std::uint8_t>('1' + to)});
        air.forget();
        air.request(from, 0x0A, with({1}, address_of(to), {remote_port}));
        air.run(60 * cosim::kSecond);
        REQUIRE(air.packets(from).size() == 2);
        return air.packets(from)[1].data.at(0);
    };
    CHECK(attempt(0, 7) == kRfcommNobody);
    CHECK(attempt(0, 1, 2) == kRfcommInvalidPort);
    CHECK(air.ask(2, 0x06, {0, 1}) == Bytes{0});  // not connectable
    CHECK(attempt(0, 2) == kRfcommNobody);
    CHECK(attempt(0, 1) == kRfcommOk);
    // The port is in use, here and there.
    CHECK(air.ask(0, 0x0A, with({1}, address_of(2), {1})).at(0) == 0x22);
    CHECK(attempt(3, 1) == kRfcommFailed);
    // Two links: no transparent mode.
    CHECK(air.ask(0, 0x0A, with({2}, address_of(3), {1})).at(0) == 0);
    // Robot 3 still has the PIN of its own attempt.
    air.ask(0, 0x17, {4, '0', '0', '0', '2'});
    air.run(60 * cosim::kSecond);
    CHECK(air.node.module(0).links() == 2);
    CHECK(air.ask(0, 0x11, {1}).at(0) == 0x23);
}

TEST_CASE("a robot that leaves is heard again in time, or lost", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    air.link(0, 1);
    // 15 s away: what was said meanwhile comes later, in order.
    air.place(1, 11.0, 0.0);
    air.run(5 * cosim::kSecond);
    for (const char c : std::string("abc")) {
        air.ask(0, 0x0F, {1, 1, 0, static_cast<std::uint8_t>(c)});
        air.run(3 * cosim::kSecond);
    }
    CHECK(air.lines[1].plain.empty());
    air.place(1, 9.0, 0.0);
    air.ask(0, 0x0F, {1, 1, 0, 'd'});
    air.run(1 * cosim::kSecond);
    CHECK(air.lines[1].plain == Bytes{'a', 'b', 'c', 'd'});
    air.run(30 * cosim::kSecond);
    CHECK(air.node.module(0).links() == 1);
    // 20 s away is too long for both.
    air.forget();
    air.place(0, -5.0, 0.0);
    const Time gone = air.now();
    air.run(30 * cosim::kSecond, 77 * kMs);
    CHECK(air.packets(0) == std::vector<LmxPacket>{{kInd, 0x0E, {2, 1}}});
    CHECK(air.packets(1) == std::vector<LmxPacket>{{kInd, 0x0E, {2, 1}}, {kInd, 0x11, {1, 0}}});
    CHECK(air.lines[1].breaks == 1);
    CHECK(air.lines[0].said[0].at - gone > 20 * cosim::kSecond);
    CHECK(air.lines[0].said[0].at - gone < 20 * cosim::kSecond + 10 * kMs);
    CHECK(air.report()["lost"] == 1);
}

TEST_CASE("a reset takes a module's links with it, the other notices after the timeout", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    air.link(0, 1);
    CHECK(air.ask(0, 0x4E, {0}) == Bytes{0});
    CHECK(air.ask(0, 0x55, {0x40, 0x06}) == Bytes{0});  // 1 s
    air.forget();
    // From transparent mode only a break leads to a reset.
    air.say_break(1);
    air.run(30 * kMs);
    air.request(1, 0x26);
    air.run(5 * cosim::kSecond);
    CHECK(air.packets(0) ==
          std::vector<LmxPacket>{{kInd, 0x0E, {2, 1}}, {kInd, 0x51, with({}, address_of(1), {8})}});
    CHECK(air.packets(1).back().opcode == 0x25);
    CHECK(air.node.module(1).links() == 0);
}

TEST_CASE("command mode and event filters", "[bluetooth]") {
    AirSpec spec = robots(2);
    spec.modules[1].module.settings.automatic = false;
    Air air(spec);
    air.boot();
    air.link(0, 1);
    CHECK(!air.node.module(1).transparent());
    air.ask(0, 0x0F, {1, 2, 0, 'h', 'i'});
    CHECK(air.packets(1) == std::vector<LmxPacket>{{kInd, 0x10, {1, 2, 0, 'h', 'i'}}});
    // Filter 2: silence, confirms too.
    air.forget();
    air.request(1, 0x4E, {2});
    air.run(50 * kMs);
    air.request(1, 0x16);
    air.ask(0, 0x0F, {1, 2, 0, 'h', 'o'});
    CHECK(air.packets(1).empty());
    air.request(1, 0x4E, {1});
    air.run(50 * kMs);
    CHECK(air.packets(1) == std::vector<LmxPacket>{{kCfm, 0x4E, {0}}});
}

TEST_CASE("stored connections are set up after a reset", "[bluetooth]") {
    Air air(robots(2));
    air.boot();
    air.link(0, 1);
    air.request(0, 0x0D, {1});
    air.run(10 * cosim::kSecond);
    CHECK(air.ask(0, 0x13, with({1, 1}, address_of(1), {1})) == Bytes{0});
    CHECK(air.ask(0, 0x14) == with({0, 1, 1, 1}, address_of(1), {1}));
    CHECK(air.ask(0, 0x13, with({0, 2}, address_of(2), {1})) == Bytes{0x24});
    air.forget();
    air.request(0, 0x26);
    air.run(60 * cosim::kSecond);
    REQUIRE(air.packets(0).size() == 2);
    CHECK(air.packets(0)[0].opcode == 0x25);
    CHECK(air.packets(0)[1] == LmxPacket{kInd, 0x0B, with({0}, address_of(1), {1, 1})});
    CHECK(air.node.module(0).transparent());
    CHECK(air.node.module(1).transparent());
}

TEST_CASE("a computer links by itself, again and again, and what it sent before waits", "[bluetooth]") {
    AirSpec spec = robots(1);
    ComputerOptions computer;
    computer.name = "r0.computer";
    computer.address = {1, 2, 3, 4, 5, 6};
    computer.robot = address_of(0);
    computer.pin = "0001";
    computer.connect = 2 * cosim::kSecond;
    spec.computers.push_back(computer);
    Air air(spec);
    air.boot();
    air.say_text(1, "D,100,100\r");
    air.run(60 * cosim::kSecond, 250 * kMs);
    CHECK(air.packets(0) == std::vector<LmxPacket>{{kInd, 0x0C, with({}, computer.address, {1})}});
    CHECK(std::string(air.lines[0].plain.begin(), air.lines[0].plain.end()) == "D,100,100\r");
    air.say_text(0, "d\r\n");
    air.run(1 * cosim::kSecond);
    CHECK(std::string(air.lines[1].plain.begin(), air.lines[1].plain.end()) == "d\r\n");
    air.forget();
    air.say_break(0);
    air.run(100 * kMs);
    air.request(0, 0x0D, {1});
    air.run(60 * cosim::kSecond);
    REQUIRE(air.packets(0).size() == 4);
    CHECK(air.packets(0)[2] == LmxPacket{kInd, 0x0E, {0, 1}});
    CHECK(air.packets(0)[3].opcode == 0x0C);
}
