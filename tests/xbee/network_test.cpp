// Modules and medium under the conductor: four networks side by side, and the same whatever the grants.

#include "base/error.h"
#include "base/fields/json.h"
#include "base/json.h"
#include "cosim/conductor.h"
#include "emu/radio/ether_node.h"
#include "emu/xbee/module_node.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using nlohmann::json;

namespace {

constexpr int kNetworks = 4, kEach = 3;

/// A host that asks its module to discover the network, and then sends everybody a byte.
class Asking : public cosim::Node {
  public:
    Asking(std::string name, cosim::Time at) : name_(std::move(name)) {
        using namespace protocols;
        for (const XBeeMessage& message :
             {XBeeMessage(XBeeAt{.id = 1, .command = {'N', 'D'}, .value = {}}),
              XBeeMessage(XBeeTx{.id = 2, .to = kXBeeBroadcast, .data = {0x2A}})}) {
            for (const std::uint8_t byte : encode_xbee(encode(message), XBeeApiMode::Plain)) {
                cosim::UartFrame frame;
                frame.start = at;
                frame.bit_period = 104 * cosim::kMicrosecond;
                frame.data = byte;
                frames_.push_back(frame);
                at += 10 * frame.bit_period;
            }
            at += 4 * cosim::kSecond;
        }
    }
    std::string_view name() const override { return name_; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        for (const cosim::Message& message : inbox)
            take(static_cast<std::uint8_t>(std::get<cosim::UartFrame>(message.payload).data));
        for (; next_ < frames_.size() && frames_[next_].start < until; ++next_)
            outbox.push_back({frames_[next_].start + 9 * frames_[next_].bit_period, 0, frames_[next_]});
    }
    cosim::Time earliest_output(cosim::PortIndex) const override {
        return next_ < frames_.size() ? frames_[next_].start + 9 * frames_[next_].bit_period : cosim::kNever;
    }
    cosim::Time lookahead(cosim::PortIndex) const override { return cosim::kNever; }
    std::string finish() override { return json{{"found", found_}, {"heard", heard_}}.dump(); }

  private:
    void take(std::uint8_t byte) {
        const auto reading = reader_.take(byte);
        if (!reading || !reading->ok()) return;
        const auto message = protocols::decode_xbee(reading->data);
        if (const auto* answer = std::get_if<protocols::XBeeAtResponse>(&message);
            answer && answer->value.size() > 11)
            found_.emplace_back(answer->value.begin() + 10, answer->value.begin() + 13);
        if (std::holds_alternative<protocols::XBeeRx>(message)) ++heard_;
    }

    std::string name_;
    std::vector<cosim::Port> ports_{{"uart", cosim::PortKind::Uart}};
    std::vector<cosim::UartFrame> frames_;
    std::size_t next_ = 0;
    protocols::XBeeReader reader_{protocols::XBeeApiMode::Plain};
    std::vector<std::string> found_;
    int heard_ = 0;
};

struct World {
    std::vector<cosim::NodeSpec> nodes;
    std::vector<cosim::LinkSpec> links;
};

/// Three modules in each of four networks: two PAN ids on each of two channels, all in one room.
World four_networks() {
    World world;
    json stations = json::array();
    for (int i = 0; i < kNetworks * kEach; ++i) {
        const int network = i / kEach;
        const std::string name = fmt::format("m{}", i), host = fmt::format("host{}", i);
        const json parameters{
            {"AP", 1}, {"CA", 58}, {"NT", 0x20}, {"ID", 0x1B2 + network % 2}, {"CH", 12 + network / 2}};
        const json module{{"name", name},
                          {"address", fmt::format("0013A200400000{:02X}", i)},
                          {"node_identifier", fmt::format("N{}{}", network, i % kEach)},
                          {"parameters", parameters}};
        world.nodes.push_back({name, json{{"kind", "xbee"}, {"node", module}}.dump()});
        world.nodes.push_back({host, json{{"kind", "host"}, {"name", host}, {"at", 200 + 70 * i}}.dump()});
        world.links.push_back({name, {host, "uart"}, {name, "uart"}, 9600.0});
        cosim::LinkSpec air{name + ".radio", {name, "radio"}, {"ether", name}};
        air.latency = cosim::kMicrosecond;
        world.links.push_back(air);
        stations.push_back({{"name", name}, {"at", {0.5 * (i % kEach), 0.4 * network, 0.0}}});
    }
    world.nodes.push_back({"ether", json{{"kind", "ether"}, {"node", {{"stations", stations}}}}.dump()});
    return world;
}

std::unique_ptr<cosim::Node> make(const std::string& text) {
    const json spec = json::parse(text);
    const JsonValue fields = parse_json(spec.value("node", json()).dump());
    if (spec["kind"] == "xbee") {
        xbee::ModuleSpec module;
        from_value(module, fields, "xbee");
        return std::make_unique<xbee::ModuleNode>(module.module, module.pins);
    }
    if (spec["kind"] == "ether") {
        radio::EtherSpec ether;
        from_value(ether, fields, "ether");
        return std::make_unique<radio::EtherNode>(ether);
    }
    return std::make_unique<Asking>(spec["name"], spec["at"].get<int>() * cosim::kMillisecond);
}

cosim::Outcome run(const World& world, std::uint64_t chop_seed,
                   const std::vector<cosim::FaultSpec>& faults = {}) {
    cosim::RunOptions options;
    options.in_process = true;
    options.duration = 9 * cosim::kSecond;
    options.chop_seed = chop_seed;
    cosim::Conductor conductor(world.nodes, world.links, faults, options, make);
    return conductor.run();
}

}  // namespace

TEST_CASE("four networks in one room: each finds and hears its own, and no other") {
    const World world = four_networks();
    const cosim::Outcome outcome = run(world, 0);
    INFO(outcome.text);
    REQUIRE(outcome.reason == cosim::EndReason::Duration);
    for (const auto& node : outcome.nodes) {
        if (!node.name.starts_with("host")) continue;
        const int i = std::stoi(node.name.substr(4));
        const json report = json::parse(node.json);
        INFO(node.name);
        // Two neighbours each.
        CHECK(report["heard"] == kEach - 1);
        CHECK(report["found"].size() == kEach - 1);
        for (const auto& name : report["found"])
            CHECK(name.get<std::string>().substr(0, 2) == fmt::format("N{}", i / kEach));
    }
    for (const std::uint64_t seed : {3u, 4u}) {
        const cosim::Outcome chopped = run(world, seed);
        CHECK(chopped.trace_sha256 == outcome.trace_sha256);
    }
}

TEST_CASE("what a radio link cannot suffer is refused") {
    CHECK_THROWS_WITH(run(four_networks(), 0, {{"m0.radio", "", "stuck"}}),
                      Catch::Contains("stuck on a radio link") && Catch::Contains("drop, flip, delay"));
}
