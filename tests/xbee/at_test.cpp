// AT commands: reading, setting, queueing, keeping, refusing.

#include "base/fields/json.h"
#include "host.h"

#include "base/error.h"

using namespace puckloop;
using namespace puckloop::xbee;
using namespace puckloop::xbee::test;

TEST_CASE("the module reports its start, and answers with the bytes of the fact sheet") {
    Host host;
    host.run(49 * kMs);
    CHECK(host.bytes.empty());
    host.run(20 * kMs);
    CHECK(host.bytes == XBeeBytes{0x7E, 0x00, 0x02, 0x8A, 0x00, 0x75});
    CHECK(host.starts.front() == 50 * kMs);
    CHECK(host.starts[1] - host.starts[0] == 10 * kBit);
    host.boot();
    // The TAM's requests (fact sheet, section 6), byte for byte.
    host.say_bytes(XBeeBytes{0x7E, 0x00, 0x05, 0x08, 0x01, 0x4E, 0x54, 0x82, 0xD2});
    host.run(50 * kMs);
    CHECK(host.bytes == XBeeBytes{0x7E, 0x00, 0x05, 0x88, 0x01, 0x4E, 0x54, 0x00, 0xD4});
    host.bytes.clear();
    host.say_bytes(XBeeBytes{0x7E, 0x00, 0x06, 0x08, 0x01, 0x49, 0x44, 0x01, 0xB5, 0xB3});
    host.run(50 * kMs);
    CHECK(host.bytes == XBeeBytes{0x7E, 0x00, 0x05, 0x88, 0x01, 0x49, 0x44, 0x00, 0xE9});
    host.bytes.clear();
    host.say_bytes(XBeeBytes{0x7E, 0x00, 0x04, 0x08, 0x01, 0x53, 0x48, 0x5B});
    host.run(50 * kMs);
    // 0x13 is escaped.
    CHECK(host.bytes ==
          XBeeBytes{0x7E, 0x00, 0x09, 0x88, 0x01, 0x53, 0x48, 0x00, 0x00, 0x7D, 0x33, 0xA2, 0x00, 0x26});
}

TEST_CASE("parameters are read with their size and set within their range") {
    Host host;
    host.boot();
    CHECK(host.ask("AP").value == XBeeBytes{2});
    CHECK(host.ask("HV").value == XBeeBytes{0x17, 0x44});
    CHECK(host.ask("SL").value == XBeeBytes{0x40, 0x8C, 0x04, 0xA4});
    CHECK(host.ask("NI").value == XBeeBytes{'T', 'A', 'M', '0', '7'});
    for (const AtParameter& parameter : at_table()) {
        INFO(parameter.command);
        const std::string command(parameter.command);
        CHECK(host.ask(command).value.size() == static_cast<std::size_t>(parameter.octets));
        const auto octets = [&](std::uint64_t number, int count) {
            XBeeBytes value;
            for (int shift = 8 * (count - 1); shift >= 0; shift -= 8)
                value.push_back(static_cast<std::uint8_t>(number >> shift));
            return value;
        };
        if (parameter.read_only) {
            CHECK(host.ask(command, {1}).status == kAtBadValue);
            continue;
        }
        if (command == "BD" || command == "AP") continue;
        CHECK(host.ask(command, octets(parameter.most, parameter.octets)).status == kAtOk);
        CHECK(host.ask(command).value == octets(parameter.most, parameter.octets));
        if (std::uint64_t{parameter.most} + 1 < std::uint64_t{1} << 8 * parameter.octets)
            CHECK(host.ask(command, octets(std::uint64_t{parameter.most} + 1, parameter.octets)).status ==
                  kAtBadValue);
        CHECK(host.ask(command, XBeeBytes(static_cast<std::size_t>(parameter.octets) + 1, 0)).status ==
              kAtBadValue);
        if (parameter.least > 0) CHECK(host.ask(command, {0}).status == kAtBadValue);
        CHECK(host.ask(command).value == octets(parameter.most, parameter.octets));
        CHECK(host.ask(command, octets(parameter.factory, parameter.octets)).status == kAtOk);
    }
    CHECK(host.ask("NI", XBeeBytes(21, 'x')).status == kAtBadValue);
    CHECK(host.ask("NI", {'a', 0x01}).status == kAtBadValue);
    CHECK(host.ask("SH", {1}).status == kAtBadValue);
}

TEST_CASE("unknown commands are answered with status 2 and counted by name") {
    Host host;
    host.boot();
    for (const char* command : {"QQ", "ZZ", "QQ"}) {
        CHECK(host.ask(command).status == kAtUnknown);
        CHECK(host.ask(command, {1, 2}).status == kAtUnknown);
    }
    const auto at = host.report()["at"];
    CHECK(at["unknown"]["QQ"] == 4);
    CHECK(at["unknown"]["ZZ"] == 2);
    // However many names there are, the report stays small.
    for (char a = 'a'; a <= 'z'; ++a)
        for (char b = 'a'; b <= 'c'; ++b)
            CHECK(host.ask({a, b}).status == kAtUnknown);
    CHECK(host.report()["at"]["unknown"].size() <= 33);
}

TEST_CASE("09 queues, AC, WR and the next 08 apply, WR keeps, reset forgets the rest") {
    Host host;
    host.boot();
    CHECK(host.ask("RR", {3}, true).status == kAtOk);
    CHECK(host.ask("RR", {}, true).value == XBeeBytes{0x0A});
    CHECK(host.ask("AC", {}, true).status == kAtOk);
    CHECK(host.ask("RR", {}, true).value == XBeeBytes{3});
    CHECK(host.words.back().second.mac_retries == 3);
    CHECK(host.ask("RR", {4}, true).status == kAtOk);
    CHECK(host.ask("SH").value.size() == 4);
    CHECK(host.ask("RR", {}, true).value == XBeeBytes{4});
    CHECK(host.ask("MT", {1}, true).status == kAtOk);
    CHECK(host.ask("WR", {}, true).status == kAtOk);
    CHECK(host.ask("MT").value == XBeeBytes{1});
    CHECK(host.ask("MT", {2}).status == kAtOk);
    CHECK(host.ask("NI", {'X'}).status == kAtOk);
    // FR: answered first, then start and modem status.
    CHECK(host.ask("FR").status == kAtOk);
    host.run(200 * kMs);
    REQUIRE(std::holds_alternative<XBeeModemStatus>(host.said.back().second));
    CHECK(std::get<XBeeModemStatus>(host.said.back().second).status == 1);
    CHECK(host.ask("MT").value == XBeeBytes{1});
    CHECK(host.ask("RR").value == XBeeBytes{4});
    CHECK(host.ask("NI").value == XBeeBytes{'T', 'A', 'M', '0', '7'});
}

TEST_CASE("frame id 0 asks for no answer") {
    Host host;
    host.boot();
    host.say(XBeeAt{.id = 0, .command = {'R', 'R'}, .value = {5}});
    host.run(100 * kMs);
    CHECK(host.bytes.empty());
    CHECK(host.ask("RR").value == XBeeBytes{5});
}

TEST_CASE("the reset pin: silent while held, then status 0 after the start, values from flash") {
    Host host;
    host.boot();
    CHECK(host.ask("RR", {7}).status == kAtOk);
    host.pin(1, 1.0);
    host.run(20 * kMs);
    CHECK_FALSE(host.words.back().second.on);
    const std::size_t before = host.bytes.size();
    host.say(XBeeAt{.id = 1, .command = {'R', 'R'}, .value = {}});
    host.run(100 * kMs);
    CHECK(host.bytes.size() == before);
    const Time released = host.now();
    host.pin(1, 0.0);
    host.run(100 * kMs);
    CHECK(host.starts[before] == released + 50 * kMs);
    CHECK(std::get<XBeeModemStatus>(host.said.back().second).status == 0);
    CHECK(host.words.back().second.on);
    CHECK(host.ask("RR").value == XBeeBytes{0x0A});
    CHECK(host.report()["resets"] == 1);
    CHECK(host.report()["uart"]["while_down"] == 8);
}

TEST_CASE("AP 1: frames without escapes, BD: answers in the old rate, then the new one") {
    Host host;
    host.boot();
    host.ask("AP", {1});
    host.reader = XBeeReader(XBeeApiMode::Plain);
    host.say(XBeeAt{.id = 1, .command = {'S', 'H'}, .value = {}}, XBeeApiMode::Plain);
    host.run(100 * kMs);
    CHECK(std::count(host.bytes.begin(), host.bytes.end(), 0x7D) == 0);
    host.say(XBeeAt{.id = 1, .command = {'B', 'D'}, .value = {0, 0, 0, 7}}, XBeeApiMode::Plain);
    host.starts.clear();
    host.run(100 * kMs);
    CHECK(host.starts[1] - host.starts[0] == 10 * kBit);
    host.starts.clear();
    // 115200 is 111111 with this divider.
    host.say_bytes(
        encode_xbee(encode(XBeeAt{.id = 1, .command = {'R', 'R'}, .value = {}}), XBeeApiMode::Plain),
        9 * kUs);
    host.run(100 * kMs);
    REQUIRE(host.starts.size() > 2);
    CHECK(host.starts[1] - host.starts[0] == 90 * kUs);
    CHECK(host.node.module().counts().framing_errors == 0);
}

TEST_CASE("what no module can be set to is refused when it is made") {
    ModuleOptions options = escaped();
    options.parameters.emplace_back("CH", 30);
    CHECK_THROWS_WITH(Host(options), Catch::Contains("CH = 0x1e is out of range"));
    options = escaped();
    options.parameters.emplace_back("XX", 1);
    CHECK_THROWS_WITH(Host(options), Catch::Contains("no AT parameter XX"));
    options = escaped("");
    CHECK_THROWS_AS(Host(options), InputError);
    ModuleSpec spec;
    CHECK_THROWS_WITH(from_value(spec, parse_json(R"({"address": "hello"})"), "xbee"),
                      "xbee.address: bad address (expected 16 hex digits)");
    CHECK_THROWS_WITH(from_value(spec, parse_json(R"({"adress": "0"})"), "xbee"), "xbee.adress: unknown key");
}
