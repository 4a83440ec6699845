// Faults of the air between modules: what each does to frames, whom it leaves alone, what it reports that it
// did.

#include "cosim/faults/fault_json.h"
#include "cosim/faults/kinds/kind_table.h"
#include "tests/radio/air.h"

#include "base/error.h"
#include "base/random.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::radio;
using namespace puckloop::radio::test;

namespace {

cosim::FaultSpec fault(const std::string& kind, const std::string& from = "") {
    cosim::FaultSpec spec;
    spec.node = "ether";
    spec.kind = kind;
    spec.from = from;
    spec.name = kind;
    return spec;
}

/// As it comes to the node: by the description.
std::vector<cosim::CarriedFault> carried(std::vector<cosim::FaultSpec> specs, std::uint64_t seed = 1) {
    auto list = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const cosim::KindInfo* kind = cosim::find_kind(specs[i].kind, cosim::PlaceKind::Xbee);
        REQUIRE(kind != nullptr);
        cosim::complete(specs[i], *kind);
        cosim::check_fault(specs[i], *kind);
        list.push_back(cosim::fault_to_json(specs[i], seed, i));
    }
    return cosim::faults_from_json(list);
}

const std::vector<Position> kThree{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

struct Run {
    nlohmann::json report{};
    std::vector<std::vector<std::uint8_t>> got{};  ///< by station 1
    int delivered = 0, undelivered = 0, retries = 0;
    nlohmann::json fired(std::size_t i = 0) const { return report["faults"].at(i)["fired"]; }
    std::string what(std::size_t firing = 0) const {
        return report["faults"].at(0)["firings"].at(firing).at(2);
    }
};

/// Station 0 sends `packets` to station 1, one each 100 ms.
Run talk(const std::vector<cosim::FaultSpec>& faults, int packets = 20, std::uint8_t cca = 58,
         std::uint64_t seed = 1) {
    Run run;
    Air air(kThree, 30.0, 0.0, seed, carried(faults, seed));
    for (RadioSettings& settings : air.settings)
        settings.cca = cca;
    air.tell_all();
    air.run(10 * kMs);
    for (int i = 0; i < packets; ++i) {
        air.send(0, address(1), {0x42, static_cast<std::uint8_t>(i)});
        air.run(air.now() + 100 * kMs, 3 * kMs);
    }
    air.run(air.now() + 20'000 * kMs);
    run.report = air.report();
    run.got = air.data_of(1);
    for (const Air::Fate& fate : air.fates) {
        ++(fate.outcome.delivery == kDelivered ? run.delivered : run.undelivered);
        run.retries += fate.outcome.retries;
    }
    return run;
}

}  // namespace

TEST_CASE("without faults a report has none") {
    const Run run = talk({});
    CHECK(run.delivered == 20);
    CHECK(run.report["stations"]["m0"]["mac"]["retries"] == 0);
    CHECK_FALSE(run.report.contains("faults"));
}

TEST_CASE("a frame lost on air is sent again by the MAC") {
    auto loss = fault("loss", "m0").set("frame", "data").set("to", "m1");
    loss.skip = 3;
    loss.count = 2;
    const Run run = talk({loss});
    CHECK(run.delivered == 20);
    CHECK(run.got.size() == 20);
    CHECK(run.fired() == 2);
    CHECK(run.report["stations"]["m0"]["mac"]["retries"] == 2);
    CHECK(run.report["stations"]["m1"]["mac"]["noise"] == 2);
    CHECK(run.report["stations"]["m2"]["mac"]["noise"] == 0);
    CHECK(run.what() == "data from m0 to m1 sequence 4 hop 1");
    CHECK(run.what(1) == run.what());
    // All of them: the packets are given up, and the sender knows.
    const Run deaf = talk({fault("loss").set("to", "m1")}, 3);
    CHECK(deaf.delivered == 0);
    CHECK(deaf.undelivered == 3);
    CHECK(deaf.got.empty());
}

TEST_CASE("a lost acknowledgement makes the sender repeat what has come, and it is not handed on twice") {
    auto loss = fault("loss").set("frame", "mac_ack").set("to", "m0");
    loss.count = 4;
    const Run run = talk({loss});
    CHECK(run.fired() == 4);
    CHECK(run.what().starts_with("mac_ack from m"));
    CHECK(run.report["stations"]["m0"]["mac"]["retries"] == 4);
    CHECK(run.report["stations"]["m1"]["mac"]["received_twice"] == 4);
    CHECK(run.got.size() == 20);
}

TEST_CASE("bits that flip on air are found by the frame's check") {
    auto corrupt = fault("corrupt", "m0").set("frame", "data").set("bits", 3);
    corrupt.probability = 0.3;
    const Run run = talk({corrupt}, 40);
    CHECK(run.fired() > 5);
    CHECK(run.report["stations"]["m0"]["mac"]["retries"].get<int>() >= run.fired().get<int>());
    CHECK(run.got.size() == 40);
    for (std::uint8_t i = 0; i < 40; ++i)
        CHECK(run.got[i] == std::vector<std::uint8_t>{0x42, i});
    // The pattern names one of them.
    auto named = fault("corrupt").set("frame", "data");
    named.match = {0x42, 0x07};
    named.count = 1;
    const Run one = talk({named});
    CHECK(one.fired() == 1);
    CHECK(one.what() == "data from m0 to m1 sequence 8 hop 1");
}

TEST_CASE("a foreign network on the channel keeps modules from reading and from sending") {
    // Loud: nothing that falls into its frames is read; the MAC's and the network's repetitions get through.
    const Run loud = talk({fault("clash").set("dbm", -20).set("load", 0.2)}, 40, 0);
    CHECK(loud.fired() > 10);
    CHECK(loud.what().find("is not read by") != std::string::npos);
    CHECK(loud.report["stations"]["m1"]["mac"]["collisions"].get<int>() > 0);
    CHECK(loud.report["stations"]["m0"]["mac"]["retries"].get<int>() > 5);
    CHECK(loud.delivered > 10);
    // Weak: captured.
    const Run weak = talk({fault("clash").set("dbm", -90).set("load", 0.5)}, 40);
    CHECK(weak.fired() == 0);
    CHECK(weak.delivered == 40);
    // On another channel: nothing.
    CHECK(talk({fault("clash").set("dbm", -20).set("channel", 20)}).fired() == 0);
    // Modules that listen first wait for it.
    const Run polite = talk({fault("clash").set("dbm", -20).set("load", 0.5)}, 40, 58);
    bool waited = false;
    for (const auto& firing : polite.report["faults"][0]["firings"])
        waited |= firing.at(2).get<std::string>().find("waits for a free channel") != std::string::npos;
    CHECK(waited);
    // Always there: nobody ever sends.
    const Run jammed = talk({fault("clash").set("dbm", -20).set("load", 1)}, 3, 58);
    CHECK(jammed.delivered == 0);
    CHECK(jammed.undelivered == 3);
    CHECK(jammed.report["stations"]["m0"]["mac"]["frames"] == 0);
    // Only while it is there.
    auto late = fault("clash").set("dbm", -20).set("load", 1);
    late.begin = 1500 * kMs;
    late.end = 1600 * kMs;
    const Run window = talk({late});
    CHECK(window.fired() > 0);
    for (const auto& firing : window.report["faults"][0]["firings"]) {
        CHECK(firing.at(0).get<Time>() >= late.begin - 10 * kMs);
        CHECK(firing.at(0).get<Time>() < late.end + 5 * kMs);  // its last frame
    }
    // Heard by one only.
    const Run one = talk({fault("clash").set("dbm", -20).set("load", 1).set("to", "m2")});
    CHECK(one.delivered == 20);
}

TEST_CASE("a fault of the air draws from its own stream, and cuts change nothing") {
    const auto run = [](Time step, const std::vector<cosim::FaultSpec>& faults) {
        Air air(kThree, 30.0, 0.2, 7, carried(faults, 7));
        air.tell_all();
        air.run(10 * kMs, step);
        RandomStream random(1, "packets");
        for (int i = 0; i < 30; ++i) {
            const std::size_t from = random.below(3);
            air.send(from, i % 5 == 0 ? protocols::kXBeeBroadcast : address((from + 1) % 3), {1, 2, 3});
            air.run(air.now() + static_cast<Time>(random.below(60)) * kMs + 1, step);
        }
        air.run(air.now() + 20'000 * kMs, step);
        std::vector<std::pair<Time, std::size_t>> got;
        for (const Air::Got& one : air.got)
            got.emplace_back(one.at, one.station);
        return std::pair(got, air.report().dump());
    };
    std::vector<cosim::FaultSpec> faults{fault("loss").set("frame", "data"), fault("corrupt"),
                                         fault("clash").set("load", 0.2)};
    faults[0].probability = faults[1].probability = 0.1;
    const auto whole = run(cosim::kNever, faults);
    CHECK(whole == run(kMs / 7, faults));
    CHECK(whole == run(5 * kMs, faults));
    // One that never fires leaves all others as they were, and the air, too.
    auto never = fault("loss");
    never.begin = 3'000'000 * kMs;
    CHECK(run(kMs, {never}).first == run(kMs, {}).first);
    CHECK(whole.first != run(kMs, {}).first);
}

TEST_CASE("a fault for a module that is not there is refused") {
    CHECK_THROWS_WITH(Air(kThree, 30.0, 0.0, 1, carried({fault("loss", "m7")})),
                      Catch::Contains("there is no module of 'm7'") && Catch::Contains("m0, m1, m2"));
    CHECK_THROWS_AS(carried({fault("clash").set("load", 0.0)}), InputError);
    CHECK_THROWS_AS(carried({fault("loss").set("frame", "beacon")}), InputError);
    CHECK_THROWS_AS(carried({fault("corrupt").set("bits", 0.0)}), InputError);
}
