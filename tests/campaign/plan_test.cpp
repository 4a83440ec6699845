// Which cases there are: grids, positions in records, what is pruned, pairs of survivors.

#include "base/random.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/findings.h"
#include "campaigns/engine/positions.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <set>

using namespace puckloop;
using namespace puckloop::faults;
using nlohmann::json;

namespace {

constexpr double kByte = 10 / 115200.0;

/// Records of `length` bytes every 100 ms from `first` on.
Sender records(double first, int count, int length) {
    Sender sender;
    for (int record = 0; record < count; ++record)
        for (int byte = 0; byte < length; ++byte) {
            sender.times.push_back(first + 0.1 * record + byte * kByte);
            sender.values.push_back(byte == 0 ? "4e" : "00");
            sender.frame_s.push_back(kByte);
        }
    return sender;
}

Campaign hello_campaign() {
    Campaign campaign;
    campaign.file = "test.toml";
    campaign.scenario = PUCKLOOP_SOURCE "/scenarios/hello.toml";
    campaign.seeds = {1};
    campaign.duration = 5;
    return campaign;
}

}  // namespace

TEST_CASE("a byte of the Linux board's protocol is named by record and field") {
    Profile nominal;
    nominal.senders["robot0.uart from robot0.pic"] = records(1, 3, 72);
    Sender& program = nominal.senders["robot0.uart from robot0.linux"];
    program = records(1.05, 2, 12);
    Sweep sweep;
    sweep.positions = true;
    sweep.records = {1};
    const auto names = [&](const char* from, const std::vector<int>& bytes) {
        sweep.bytes = bytes;
        std::vector<std::string> all;
        for (const Position& position :
             positions_of(sweep, json{{"link", "robot0.uart"}, {"from", from}}, nominal))
            all.push_back(position.name);
        return all;
    };
    using Names = std::vector<std::string>;
    CHECK(names("robot0.pic", {0, 15, 24, 71, 72}) ==
          Names{"sensors rab_data low (byte 0)", "sensors proximity[3] high (byte 15)",
                "sensors battery_ok low (byte 24)", "sensors ircom_bearing byte 3 (byte 71)", "byte 72"});
    CHECK(names("robot0.linux", {1, 6, 10}) ==
          Names{"actuators left high (byte 1)", "actuators ring_leds (byte 6)", "actuators reset (byte 10)"});
    // The last byte by itself, as the project's own program writes it.
    program = {};
    for (const double begin : {1.05, 1.15, 1.25}) {
        const Sender first = records(begin, 1, 11), last = records(begin + 0.01, 1, 1);
        for (const Sender* part : {&first, &last}) {
            program.times.insert(program.times.end(), part->times.begin(), part->times.end());
            program.values.insert(program.values.end(), part->values.begin(), part->values.end());
            program.frame_s.insert(program.frame_s.end(), part->frame_s.begin(), part->frame_s.end());
        }
    }
    CHECK(names("robot0.linux", {2, 10, 11, 12}) == Names{"actuators right low (byte 2)",
                                                          "actuators reset (byte 10)",
                                                          "actuators padding (byte 11)", "byte 12"});
    const json command{{"link", "robot0.uart"}, {"from", "robot0.linux"}};
    CHECK(positions_of(sweep, command, nominal)[2].begin == "1.160000 s");
    sweep.bytes.reset();
    CHECK(positions_of(sweep, command, nominal).size() == 12);
    sweep.records = {2};
    CHECK(positions_of(sweep, command, nominal)[0].begin == "1.250000 s");
    sweep.after = 1.155;  // between the first command's bytes and its last one
    sweep.records = {0};
    CHECK(positions_of(sweep, command, nominal)[0].begin == "1.250000 s");
    sweep.records = {1};
    CHECK_FALSE(positions_of(sweep, command, nominal)[0].missing.empty());
    // Another protocol.
    sweep.records = {1};
    nominal.senders["robot0.uart from robot0.pic"] = records(1, 3, 40);
    CHECK(names("robot0.linux", {1}) == Names{"byte 1"});
}

TEST_CASE("a byte's position is a time of the nominal run") {
    RandomStream random(GENERATE(1, 2, 3, 4), "positions");
    const int length = 2 + static_cast<int>(random.below(80));
    const double first = 1 + random.uniform();
    Profile nominal;
    nominal.senders["robot0.uart from robot0.pic"] = records(first, 20, length);
    Sweep sweep;
    sweep.positions = true;
    const int record = static_cast<int>(random.below(10)), skipped = static_cast<int>(random.below(8)),
              byte = static_cast<int>(random.below(static_cast<std::uint64_t>(length)));
    sweep.records = {record};
    sweep.after = first + 0.1 * skipped - 0.05;
    const json fault{{"link", "robot0.uart"}, {"from", "robot0.pic"}};
    sweep.bytes = std::vector<int>{byte, length};
    const auto some = positions_of(sweep, fault, nominal);
    REQUIRE(some.size() == 2);
    const double begin = std::stod(some[0].begin), wanted = first + 0.1 * (record + skipped) + byte * kByte;
    CHECK(begin <= wanted);
    CHECK(begin > wanted - 1.1e-6);
    CHECK(!some[1].missing.empty());
    sweep.bytes.reset();
    CHECK(positions_of(sweep, fault, nominal).size() == static_cast<std::size_t>(length));
    sweep.records = {25};
    CHECK(!positions_of(sweep, fault, nominal).at(0).missing.empty());
}

TEST_CASE("faults on what the nominal run never sent are pruned") {
    Profile nominal;
    nominal.senders["robot0.uart from robot0.pic"] = records(1.0, 20, 12);
    const json base{{"link", "robot0.uart"}, {"kind", "drop"}};
    const auto with = [&](const json& more) {
        json fault = base;
        fault.update(more);
        return useless(fault, nominal);
    };
    CHECK(with(json::object()).empty());
    CHECK(with({{"begin", "2 s"}}).empty());
    CHECK(!with({{"begin", "4 s"}}).empty());
    CHECK(!with({{"end", "900 ms"}}).empty());
    CHECK(!with({{"from", "robot0.linux"}}).empty());
    CHECK(!with({{"link", "robot1.uart"}}).empty());
    CHECK(with({{"bytes", {"0x4E"}}}).empty());
    CHECK(with({{"bytes", {"78"}}}).empty());
    CHECK(!with({{"bytes", {"0x4F"}}}).empty());
    // The line itself suffers: frames or none.
    CHECK(with({{"kind", "stuck"}, {"begin", "4 s"}}).empty());
    CHECK(with({{"kind", "a kind of tomorrow"}, {"begin", "4 s"}}).empty());
    // A bus: one master, transfers with one device for two seconds.
    nominal.senders["robot0.i2c.linux from robot0.linux"] = records(1.0, 20, 3);
    nominal.senders["robot0.i2c.linux from robot0.linux"].addresses = {"40", "41"};
    const auto on_bus = [&](json more) {
        more["link"] = "robot0.i2c";
        return useless(more, nominal).empty();
    };
    CHECK(on_bus({{"kind", "nack"}}));
    CHECK(on_bus({{"kind", "nack"}, {"address", 0x20}, {"from", "robot0.linux"}, {"begin", "2 s"}}));
    CHECK(!on_bus({{"kind", "nack"}, {"address", 0x21}}));
    CHECK(!on_bus({{"kind", "nack"}, {"from", "robot0.pic"}}));
    CHECK(!on_bus({{"kind", "flip"}, {"begin", "4 s"}}));
    CHECK(!on_bus({{"kind", "stretch"}, {"begin", "200 ms"}, {"for", "500 ms"}}));
    CHECK(on_bus({{"kind", "sda"}, {"begin", "200 ms"}, {"for", "500 ms"}}));
}

TEST_CASE("a sweep is every combination, and a budget is a sample that stays the same") {
    Campaign campaign = hello_campaign();
    Sweep sweep;
    sweep.name = "all";
    sweep.fault = {{"link", "robot0.uart"}};
    sweep.over = {{"from", {"robot0.linux", "robot0.pic"}}, {"kind", {"drop", "flip", "duplicate"}}};
    sweep.times = {"2 s", "2.5 s", "3 s", "3.5 s"};
    campaign.sweeps = {sweep, sweep};  // what is there twice is run once
    Nominals nominals;
    for (const std::uint64_t seed : {1, 2})
        for (const char* sender : {"robot0.uart from robot0.pic", "robot0.uart from robot0.linux"})
            nominals[seed].senders[sender] = records(1.0, 40, 12);
    campaign.seeds = {1, 2};
    const auto scenario = scenario_of(campaign);
    const auto cases = plan_singles(campaign, scenario, nominals);
    CHECK(cases.size() == 2 * 2 * 3 * 4);
    std::set<std::string> different;
    for (const Case& one : cases)
        different.insert(std::to_string(one.seed) + in_one_line(one.faults));
    CHECK(different.size() == cases.size());
    campaign.cases = 17;
    const auto sampled = plan_singles(campaign, scenario, nominals),
               again = plan_singles(campaign, scenario, nominals);
    const auto run = [](const std::vector<Case>& list) {
        std::set<int> ids;
        for (const Case& one : list)
            if (one.pruned.empty()) ids.insert(one.id);
        return ids;
    };
    CHECK(sampled.size() == cases.size());
    CHECK(run(sampled).size() == 17);
    CHECK(run(sampled) == run(again));
}

TEST_CASE("pairs are made of survivors alone, and not more than asked for") {
    RandomStream random(GENERATE(5, 6, 7), "pairs");
    Campaign campaign = hello_campaign();
    std::vector<CaseResult> singles;
    std::set<std::string> survivors;
    for (int i = 0; i < 60; ++i) {
        CaseResult result;
        result.one.id = i + 1;
        result.one.phase = "single";
        result.one.seed = 1 + random.below(2);
        result.one.faults = {{{"number", i}}};
        result.verdict.outcome = kOutcomes.at(random.below(kOutcomes.size()));
        if (!is_finding(result.verdict.outcome) && result.verdict.outcome != Outcome::NotFired)
            survivors.insert(result.one.faults[0].dump());
        singles.push_back(result);
    }
    campaign.pairs = 10;
    const auto pairs = plan_pairs(campaign, singles, 100);
    CHECK(pairs.size() == 10);
    std::set<std::string> different;
    for (const Case& pair : pairs) {
        REQUIRE(pair.faults.size() == 2);
        for (const json& fault : pair.faults) {
            CHECK(survivors.contains(fault.dump()));
            CHECK(singles.at(fault["number"]).one.seed == pair.seed);
        }
        CHECK(pair.faults[0] != pair.faults[1]);
        different.insert(in_one_line(pair.faults));
    }
    CHECK(different.size() == pairs.size());
    campaign.pairs = 0;
    CHECK(plan_pairs(campaign, singles, 100).empty());
}

TEST_CASE("the smallest count that shows a finding is found, whatever it is") {
    RandomStream random(GENERATE(1, 2, 3, 4, 5, 6, 7, 8), "fewer");
    const Campaign campaign = hello_campaign();
    const auto scenario = scenario_of(campaign);
    const std::uint64_t least = 1 + random.below(64), given = least + random.below(40);
    const bool limited = random.below(2) == 0;  // by its count, or by how often it could fire
    CAPTURE(least, given, limited);
    const auto verdict = [&](std::uint64_t count) {
        Verdict one;
        one.outcome = count >= least ? Outcome::Hang : Outcome::Masked;
        one.fired = {count};
        return one;
    };
    json fault = {{"kind", "drop"}, {"link", "robot0.uart"}, {"from", "robot0.pic"}};
    if (limited) fault["count"] = given;
    Case single;
    single.id = 1;
    single.phase = "single";
    single.faults = {fault};
    std::vector<CaseResult> results{{single, verdict(given)}};
    for (int round = 1;; ++round) {
        REQUIRE(round < 10);
        const std::string phase = round == 1 ? "fewer" : fmt::format("fewer {}", round);
        const auto cases =
            plan_fewer(campaign, scenario, results, static_cast<int>(results.size()) + 1, phase);
        if (cases.empty()) break;
        for (const Case& one : cases) {
            CHECK(one.phase == phase);
            CHECK(one.of == 1);
            results.push_back({one, verdict(one.faults[0].at("count"))});
        }
    }
    const auto findings = findings_of(results);
    REQUIRE(findings.size() == 1);
    CHECK(findings[0].smallest->verdict.fired == std::vector<std::uint64_t>{least});
    CHECK(results.size() < 20);
}
