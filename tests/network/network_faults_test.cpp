// What faults of the network do to packets.

#include "tests/network/wire_kit.h"

#include "base/error.h"
#include "cosim/faults/kinds/kind_table.h"
#include "cosim/faults/node_fault.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::FaultSpec;
using cosim::kMillisecond;

using Lines = std::vector<std::string>;

namespace {

FaultSpec fault_of(const std::string& kind) {
    FaultSpec fault;
    fault.node = "network";
    fault.kind = kind;
    fault.name = "it";
    return fault;
}

network::NetworkSpec with(FaultSpec fault) {
    network::NetworkSpec spec = three(kMillisecond);
    cosim::complete(fault, *cosim::find_kind(fault.kind, cosim::PlaceKind::Network));
    spec.faults = cosim::carried({{fault, 1, 0}});
    return spec;
}

/// Three packets from a to b, one from b to a and one from c to a, 1 ms apart.
Lines after(const FaultSpec& fault, double* fired = nullptr) {
    const std::vector<cosim::Message> sent{
        packet(0, 0, kFirst + 1, "one"), packet(kMillisecond, 0, kFirst + 1, "two"),
        packet(2 * kMillisecond, 0, kFirst + 1, "three"), packet(3 * kMillisecond, 1, kFirst, "back"),
        packet(4 * kMillisecond, 2, kFirst, "third")};
    const Lines lines = carried(with(fault), sent, 100 * kMillisecond, 100 * kMillisecond);
    CHECK(carried(with(fault), sent, 100 * kMillisecond, kMillisecond / 4) == lines);
    if (fired != nullptr) {
        network::NetworkNode node(with(fault));
        std::vector<cosim::Message> outbox;
        node.advance(cosim::kSecond, sent, outbox);
        *fired = nlohmann::json::parse(node.finish())["faults"][0]["fired"];
    }
    return lines;
}

const Lines kAll{"1000 us b one", "2000 us b two", "3000 us b three", "4000 us a back", "5000 us a third"};

Lines without(std::initializer_list<std::size_t> left_out) {
    Lines lines;
    for (std::size_t i = 0; i < kAll.size(); ++i)
        if (std::find(left_out.begin(), left_out.end(), i) == left_out.end()) lines.push_back(kAll[i]);
    return lines;
}

}  // namespace

TEST_CASE("loss takes what it is meant for", "[network]") {
    FaultSpec fault = fault_of("loss");
    double fired = 0;
    CHECK(after(fault, &fired).empty());
    CHECK(fired == 5);
    fault.from = "a";
    CHECK(after(fault) == without({0, 1, 2}));
    fault.skip = 1;
    fault.count = 1;
    CHECK(after(fault) == without({1}));
    fault = fault_of("loss");
    fault.set("to", "a");
    CHECK(after(fault) == without({3, 4}));
    fault = fault_of("loss");
    for (const char c : std::string("two"))
        fault.match.push_back(static_cast<std::uint8_t>(c));
    CHECK(after(fault, &fired) == without({1}));
    CHECK(fired == 1);
}

TEST_CASE("duplicate, delay, corrupt", "[network]") {
    FaultSpec fault = fault_of("duplicate");
    fault.count = 1;
    Lines lines = kAll;
    lines.insert(lines.begin() + 1, "1001 us b one");
    CHECK(after(fault) == lines);
    fault = fault_of("delay");
    fault.from = "b";
    fault.set("delay", 0.01);
    CHECK(after(fault) ==
          Lines{"1000 us b one", "2000 us b two", "3000 us b three", "5000 us a third", "14000 us a back"});
    fault = fault_of("corrupt");
    fault.count = 1;
    lines = kAll;
    lines[0] = "1000 us b ?";
    CHECK(after(fault) == lines);
}

TEST_CASE("a packet that is kept back comes behind the next one, or late", "[network]") {
    FaultSpec fault = fault_of("reorder");
    fault.from = "a";
    fault.count = 1;
    CHECK(after(fault) ==
          Lines{"2000 us b two", "2001 us b one", "3000 us b three", "4000 us a back", "5000 us a third"});
    fault.skip = 2;
    CHECK(after(fault) ==
          Lines{"1000 us b one", "2000 us b two", "4000 us a back", "5000 us a third", "13000 us b three"});
}

TEST_CASE("a partition holds for its time, between a group and the others", "[network]") {
    FaultSpec fault = fault_of("partition");
    double fired = 0;
    CHECK(after(fault, &fired).empty());
    CHECK(fired == 5);
    fault.set("group", "a+c");
    CHECK(after(fault) == without({0, 1, 2, 3}));
    fault.begin = kMillisecond;
    fault.end = 3 * kMillisecond;
    CHECK(after(fault) == without({1, 2}));
    fault.set("group", "a+x");
    CHECK_THROWS_AS(after(fault), InputError);
}

TEST_CASE("a cap of the rate makes packets longer", "[network]") {
    FaultSpec fault = fault_of("rate");
    fault.set("rate", 800'000.0);  // 100 octets: 1 ms
    CHECK(after(fault) ==
          Lines{"2000 us b one", "3000 us b two", "4000 us b three", "5000 us a back", "6000 us a third"});
    fault.from = "c";
    double fired = 0;
    CHECK(after(fault, &fired).back() == "6000 us a third");
    CHECK(fired == 1);
}
