// [network], [[host]], and who has which address.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "scenarios/tables/network_tables.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kBegin = "[run]\nduration = \"5 s\"\n[arena]\nsize = [\"9 m\", \"9 m\"]\n";

std::string robot(int number, const std::string& linux_keys) {
    return fmt::format("[[robot]]\nposition = [\"{} cm\", \"0 cm\"]\n[robot.pic]\nfirmware = \"own\"\n{}",
                       20 * number, linux_keys.empty() ? "" : "[robot.linux]\n" + linux_keys);
}
const std::string kProgram = "program = [\"true\"]\n";

std::vector<std::string> computers(const std::string& text) {
    const TemporaryFile file(text);
    std::vector<std::string> lines;
    for (const NetworkComputer& one : computers_of(read_scenario(file.path())))
        lines.push_back(one.name + " " + one.address);
    return lines;
}

using Lines = std::vector<std::string>;

}  // namespace

TEST_CASE("robots' addresses follow their numbers, hosts come from above", "[network]") {
    const std::string robots = robot(0, kProgram) + robot(1, "") + robot(2, kProgram);
    const std::string hosts = "[[host]]\n" + kProgram + "[[host]]\nname = \"pc\"\n" + kProgram;
    CHECK(computers(kBegin + robots).empty());
    CHECK(computers(kBegin + "[network]\n" + robots + hosts) ==
          Lines{"robot0 10.0.0.1", "robot2 10.0.0.3", "host0 10.0.0.254", "pc 10.0.0.253"});
    CHECK(computers(kBegin + "[network]\naddress = \"192.168.8.0/22\"\n" +
                    robot(0, kProgram + "address = \"192.168.9.0\"\n") + hosts) ==
          Lines{"robot0 192.168.9.0", "host0 192.168.11.254", "pc 192.168.11.253"});
}

TEST_CASE("what the network's tables set", "[network]") {
    const TemporaryFile file(
        kBegin +
        "[network]\nmode = \"fixed\"\nlatency = \"3 ms\"\nrate = \"2.5 Mbit/s\"\nqueue = 7\n"
        "[[host]]\nname = \"pc\"\nstart = \"2 s\"\n" +
        kProgram);
    const Scenario scenario = read_scenario(file.path());
    REQUIRE(scenario.network);
    CHECK(scenario.network->latency == Approx(3e-3));
    CHECK(scenario.network->rate == Approx(2.5e6));
    CHECK(scenario.network->queue == 7);
    REQUIRE(scenario.hosts.size() == 1);
    CHECK(scenario.hosts[0].board.start == Approx(2.0));
    CHECK(scenario.hosts[0].board.hostname == "pc");
    const TemporaryFile plain(kBegin + "[network]\n[[host]]\n" + kProgram);
    CHECK(read_scenario(plain.path()).network->rate == 0.0);
}

TEST_CASE("what the radio's table sets, and who has one", "[network]") {
    const TemporaryFile file(kBegin +
                             "[network]\nmode = \"wifi\"\naccess_point = [\"1 m\", \"-50 cm\"]\n"
                             "[network.wifi]\nstandard = \"b\"\nrate = \"5.5 Mbit/s\"\npower = \"8 dBm\"\n"
                             "shadowing = \"0 dB\"\nexponent = 2.5\nattempts = 4\nwall_loss = \"6.9 dB\"\n"
                             "[[host]]\nname = \"pc\"\n" +
                             kProgram + "[[host]]\nname = \"laptop\"\nposition = [\"0 m\", \"2 m\"]\n" +
                             kProgram);
    const Scenario scenario = read_scenario(file.path());
    REQUIRE(scenario.network);
    REQUIRE(scenario.network->wifi);
    const wifi::WifiSettings& radio = *scenario.network->wifi;
    CHECK(radio.standard == "b");
    CHECK(radio.rate == Approx(5.5e6));
    CHECK(radio.power == Approx(8));
    CHECK(radio.shadowing == 0);
    CHECK(radio.exponent == Approx(2.5));
    CHECK(radio.attempts == 4);
    CHECK(radio.wall_loss == Approx(6.9));
    CHECK(radio.thing_loss == 0);
    CHECK_FALSE(radio.mesh);
    // Events can send to whoever is there.
    REQUIRE(scenario.events.computers.size() == 2);
    CHECK(scenario.events.computers[0].name == "pc");
    CHECK(scenario.events.computers[0].address == 0x0a0000fe);
    CHECK(radio.carrier_sense == wifi::WifiSettings{}.carrier_sense);
    CHECK(scenario.network->latency == Approx(5e-4));
    CHECK(scenario.network->access_point->at(1) == Approx(-0.5));
    CHECK_FALSE(scenario.hosts[0].position);
    CHECK(scenario.hosts[1].position->at(1) == Approx(2));
    const auto refused = [](const std::string& text, const std::string& what) {
        const TemporaryFile bad(kBegin + text);
        CHECK_THROWS_WITH(read_scenario(bad.path()), Catch::Contains(what));
    };
    const std::string wifi = "[network]\nmode = \"wifi\"\n", table = wifi + "[network.wifi]\n";
    refused(table + "standard = \"n\"\n", "line 8: network.wifi: there is no standard 'n'");
    refused(table + "rate = \"11 Mbit/s\"\n", "802.11g has no rate of 11 Mbit/s");
    refused(table + "rate = \"11 MB\"\n", "unknown unit 'MB'");
    refused(table + "power = \"40 dBm\"\n", "power is out of range");
    refused(table + "power = \"4 dB\"\n", "is a ratio of powers");
    refused(table + "attempts = 0\n", "attempts");
    refused(table + "thing_loss = \"101 dB\"\n", "thing_loss is out of range");
    refused(table + "route_every = \"1 ms\"\n", "route_every is out of range");
    refused(wifi + "access_point = [\"0 m\", \"0 m\"]\n[network.wifi]\nmesh = true\n",
            "a mesh has no access point");
    refused(robot(0, "") + wifi + "[[event]]\nat = \"1 s\"\nsend = \"pc\"\ntext = \"x\"\n",
            "there is no computer on a network that could be 'pc'");
    refused(table + "powr = \"4 dBm\"\n", "powr");
    refused(wifi + "rate = \"11 Mbit/s\"\n", "a radio has rates of its own");
    refused(wifi + "[[host]]\n" + kProgram, "host0 has neither a radio nor a wire");
    refused("[network]\naccess_point = [\"1 m\", \"1 m\"]\n", "has no access_point");
    refused("[network]\n[[host]]\nposition = [\"1 m\", \"1 m\"]\n" + kProgram, "a host without a radio");
}

TEST_CASE("a rate is a number and its unit", "[network]") {
    CHECK(parse_rate("11 Mbit/s") == 11e6);
    CHECK(parse_rate("0.5kbit/s") == 500.0);
    CHECK(parse_rate("1e3 bit/s") == 1e3);
    for (const char* bad : {"", "11", "Mbit/s", "11 MB/s", "11 Mbit/s ", "11 mbit/s", "x 1 bit/s"})
        CHECK_FALSE(parse_rate(bad));
}

TEST_CASE("more computers than addresses, and an address without a network", "[network]") {
    std::string many = kBegin + "[network]\naddress = \"10.1.0.0/29\"\n";
    for (int i = 0; i < 6; ++i)
        many += robot(i, kProgram);
    CHECK(computers(many).size() == 6);
    CHECK_THROWS_WITH(computers(many + robot(6, kProgram)), Catch::Contains("no address left"));
    CHECK_THROWS_WITH(computers(many + "[[host]]\n" + kProgram),
                      Catch::Contains("robot5 has the address 10.1.0.6 already"));
    CHECK_THROWS_WITH(computers(kBegin + robot(0, kProgram + "address = \"10.0.0.1\"\n")),
                      Catch::Contains("an address without a network"));
}
