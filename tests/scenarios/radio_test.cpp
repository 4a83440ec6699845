// [radio], [tam.xbee], [coordinator], and faults on their links.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <set>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kHead = "[run]\nduration = \"5 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
const std::string kTam = "[[tam]]\nposition = [\"0 m\", \"0 m\"]\n";
const std::string kOther = "[[tam]]\nposition = [\"50 cm\", \"0 m\"]\nnetwork = 1\n";

std::string problem_of(const std::string& text) {
    const TemporaryFile file(text);
    try {
        read_scenario(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

}  // namespace

TEST_CASE("every TAM has a module with an address and a name of its own") {
    const TemporaryFile file(kHead + kTam + kOther + "[coordinator]\nuart = \"script:x\"\n");
    const Scenario scenario = read_scenario(file.path());
    REQUIRE(scenario.tams.size() == 2);
    REQUIRE(scenario.coordinator);
    std::set<std::uint64_t> addresses{scenario.coordinator->module.address};
    for (const TamBoard& tam : scenario.tams) {
        CHECK(tam.xbee.fitted);
        addresses.insert(tam.xbee.address);
    }
    CHECK(addresses.size() == 3);
    CHECK(scenario.tams[0].xbee.node_id == "TAM00");
    CHECK(scenario.tams[1].xbee.node_id == "TAM01");
    CHECK(scenario.tams[0].xbee.parameters.at("ID") == 0x01B5);
    CHECK(scenario.tams[1].xbee.parameters.at("ID") == 0x01B3);
    CHECK(scenario.coordinator->module.node_id == "COORD");
    CHECK(scenario.coordinator->module.parameters.at("ID") == 0x01B5);
    CHECK(scenario.radio.range == 30.0);
}

TEST_CASE("what the radio's tables set") {
    const TemporaryFile file(
        kHead + kTam +
        "[tam.xbee]\naddress = \"0013A200408C04A4\"\nnode_id = \"TAM11\"\nchannel = 15\n"
        "parameters = { RR = 3, MT = 0 }\n" +
        kOther +
        "[tam.xbee]\nfitted = false\n"
        "[radio]\nrange = \"80 cm\"\nexponent = 2\nloss = \"5 %\"\nprocessing = \"2 ms\"\n"
        "[coordinator]\nposition = [\"1 m\", \"-10 cm\"]\nnetwork = 0\nbaud = 19200\n");
    const Scenario scenario = read_scenario(file.path());
    CHECK(scenario.tams[0].xbee.address == 0x0013A200408C04A4);
    CHECK(scenario.tams[0].xbee.node_id == "TAM11");
    CHECK(scenario.tams[0].xbee.parameters.at("CH") == 15);
    CHECK(scenario.tams[0].xbee.parameters.at("RR") == 3);
    CHECK(scenario.tams[0].xbee.parameters.at("MT") == 0);
    CHECK_FALSE(scenario.tams[1].xbee.fitted);
    CHECK(scenario.radio.range == Approx(0.8));
    CHECK(scenario.radio.loss == Approx(0.05));
    CHECK(scenario.radio.processing == Approx(0.002));
    CHECK(scenario.coordinator->x == Approx(1.0));
    CHECK(scenario.coordinator->y == Approx(-0.1));
    CHECK(scenario.coordinator->baud == Approx(19200));
    CHECK(scenario.coordinator->module.parameters.at("ID") == 0x01B2);
}

TEST_CASE("what the radio's tables cannot be") {
    const auto refused = [](const std::string& text, const std::string& why) {
        CHECK_THAT(problem_of(text), Catch::Contains(why));
    };
    refused(kHead + kTam + "[tam.xbee]\naddress = \"0x13\"\n", "tam0.xbee: '0x13' is no address");
    refused(kHead + kTam + "[tam.xbee]\naddress = \"000000000000FFFF\"\n", "is no module's own address");
    refused(kHead + "[coordinator]\naddress = \"0000000000000000\"\n", "is no module's own address");
    refused(kHead + kTam + "[radio]\nexponent = nan\n", "line 8: radio: exponent: nan is not finite");
    refused(kHead + kTam + "[tam.xbee]\nnode_id = \"\"\n", "is no node identifier");
    refused(kHead + kTam + "[tam.xbee]\nchannel = 10\n", "channel");
    refused(kHead + kTam + "[tam.xbee]\nadress = \"1\"\n", "unknown key 'adress'");
    refused(kHead + kTam + "[tam.xbee]\nnode_id = \"\u00e9\"\n", "is no node identifier");
    refused(kHead + kTam + "[tam.xbee]\nparameters = { RR = 16 }\n",
            "line 8: parameters: RR is out of range (expected a whole number from 0 to 15)");
    refused(kHead + kTam + "[tam.xbee]\nparameters = { XX = 1 }\n",
            "the module has no AT parameter 'XX' to set");
    refused(kHead + kTam + "[tam.xbee]\nparameters = { NP = 1 }\n",
            "the module has no AT parameter 'NP' to set");
    refused(kHead + kTam + "[tam.xbee]\nnode_id = \"COORD\"\n", "is the coordinator's");
    refused(kHead + kTam + "[tam.xbee]\nfitted = false\nchannel = 15\n", "has no other keys");
    refused(kHead + kTam + "[tam.xbee]\nparameters = { BD = 99 }\n", "BD has no value 99");
    refused(kHead + kTam + "[radio]\nloss = 1.5\n", "loss is out of range");
    refused(kHead + kTam + "[radio]\nrange = \"0 m\"\n", "range is out of range");
    refused(kHead + kTam + "[coordinator]\nbaud = 3\n", "baud is out of range");
    refused(kHead + kTam + "[coordinator]\nnetwork = 4\n", "network");
}

TEST_CASE("faults sit on modules' lines and on the air") {
    const auto fault = [](const std::string& keys) {
        return problem_of(kHead + kTam + "[coordinator]\nuart = \"script:x\"\n[[fault]]\n" + keys);
    };
    CHECK(fault("link = \"tam0.xbee\"\nkind = \"stuck\"\nbegin = \"1 s\"\n") == "accepted");
    CHECK(fault("link = \"tam0.radio\"\nkind = \"flip\"\nfrom = \"ether\"\n") == "accepted");
    CHECK(fault("link = \"coordinator.uart\"\nfrom = \"coordinator.xbee\"\n") == "accepted");
    CHECK_THAT(fault("link = \"tam0.radio\"\nkind = \"cut\"\n"),
               Catch::Contains("unknown fault kind 'cut' for tam0.radio (expected one of drop, flip,"));
    CHECK_THAT(fault("link = \"tam0.radio\"\nbytes = [\"1\"]\n"), Catch::Contains("unknown key 'bytes'"));
    CHECK_THAT(fault("link = \"tam0.radio\"\nfrom = \"tam0.avr\"\n"),
               Catch::Contains("'tam0.avr' is at no end of tam0.radio (expected tam0.xbee or ether)"));
    CHECK_THAT(fault("link = \"tam1.radio\"\n"), Catch::Contains("tam0.xbee, tam0.radio, coordinator.uart"));
}
