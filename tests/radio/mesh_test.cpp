#include "air.h"

#include "base/error.h"
#include "base/random.h"

#include <array>

using namespace puckloop;
using namespace puckloop::radio;
using namespace puckloop::radio::test;

namespace {

constexpr Time kUs = cosim::kMicrosecond;

/// Places on a line, so far from one another that only neighbours hear each other.
std::vector<Position> line(std::size_t count) {
    std::vector<Position> places;
    for (std::size_t i = 0; i < count; ++i)
        places.push_back({20.0 * static_cast<double>(i), 0, 0});
    return places;
}

const Air::Fate& fate_of(const Air& air, std::uint16_t sequence) {
    const auto found = std::find_if(air.fates.begin(), air.fates.end(),
                                    [&](const Air::Fate& fate) { return fate.outcome.sequence == sequence; });
    REQUIRE(found != air.fates.end());
    return *found;
}

}  // namespace

TEST_CASE("a unicast arrives once, is acknowledged, and its route is known the second time") {
    Air air({{0, 0, 0}, {1, 0, 0}});
    air.tell_all();
    const std::uint16_t first = air.send(0, address(1), {1, 2, 3});
    air.run(2000 * kMs);
    REQUIRE(air.got.size() == 1);
    CHECK(air.got[0].station == 1);
    CHECK(air.got[0].frame.data == std::vector<std::uint8_t>{1, 2, 3});
    CHECK(air.got[0].frame.origin == address(0));
    CHECK(air.got[0].frame.hops == 0);
    REQUIRE(air.fates.size() == 1);
    CHECK(air.fates[0].outcome == RadioOutcome{first, 0, kDelivered, kRouteDiscovered});
    const Time sent = air.now();
    const std::uint16_t second = air.send(0, address(1), {4});
    air.run(4000 * kMs);
    const Air::Fate& fate = fate_of(air, second);
    CHECK(fate.outcome == RadioOutcome{second, 0, kDelivered, 0});
    // 802.15.4: 0 to 7 backoff units of 320 us, turnaround 192 us, 61 octets of 32 us.
    const Time on_air = air.got[1].at - sent;
    CHECK(on_air >= 192 * kUs + 61 * 32 * kUs);
    CHECK(on_air <= (7 * 320 + 192 + 61 * 32) * kUs);
    CHECK((on_air - 192 * kUs - 61 * 32 * kUs) % (320 * kUs) == 0);
    // The network acknowledgement: a millisecond of processing, then the same with 60 octets.
    const Time back = fate.at - air.got[1].at;
    CHECK(back >= (1000 + 192 + 60 * 32) * kUs);
    CHECK(back <= (1000 + 8 * 320 + 192 + 60 * 32 + 1000) * kUs);
}

TEST_CASE("nobody there: the route is looked for and not found") {
    Air air({{0, 0, 0}, {1, 0, 0}});
    air.tell_all();
    const std::uint16_t sequence = air.send(0, 0x0013A200FFFFFFFF, {1});
    air.run(5000 * kMs);
    CHECK(air.got.empty());
    const Air::Fate& fate = fate_of(air, sequence);
    CHECK(fate.outcome.delivery == kNoRoute);
    CHECK(fate.outcome.discovery == kRouteDiscovered);
    // Manual, "Transmission timeouts": NN NH (MT + 1) 18 ms, then NH hops back.
    CHECK(fate.at >= 3 * 7 * 4 * 18 * kMs);
    CHECK(fate.at <= 3 * 7 * 4 * 18 * kMs + 7 * 4 * 8 * kMs);
}

TEST_CASE("hops follow distance: a chain is crossed in as many hops as it needs") {
    for (const std::size_t count : {2u, 3u, 5u, 7u}) {
        Air air(line(count));
        air.tell_all();
        const std::uint16_t sequence = air.send(0, address(count - 1), {9});
        air.run(8000 * kMs);
        REQUIRE(air.data_of(count - 1).size() == 1);
        CHECK(air.got.size() == 1);
        CHECK(air.got[0].frame.hops == count - 2);
        CHECK(fate_of(air, sequence).outcome.delivery == kDelivered);
        CHECK(air.report()["hops"][count - 2] == 1);
        // Known now: each hop costs at least its time on air and what the module needs.
        const Time sent = air.now();
        const std::uint16_t again = air.send(0, address(count - 1), {10});
        air.run(sent + 4000 * kMs);
        REQUIRE(air.got.size() == 2);
        const auto hops = static_cast<Time>(count - 1);
        CHECK(air.got[1].at - sent >= hops * (192 + 61 * 32) * kUs + (hops - 1) * kMs);
        CHECK(fate_of(air, again).outcome.discovery == 0);
    }
}

TEST_CASE("eight hops are more than NH allows") {
    Air air(line(9));
    air.tell_all();
    const std::uint16_t sequence = air.send(0, address(8), {9});
    air.run(8000 * kMs);
    CHECK(air.got.empty());
    CHECK(fate_of(air, sequence).outcome.delivery == kNoRoute);
}

TEST_CASE("a broadcast reaches everybody once, as far as its radius") {
    Air air(line(5));
    air.tell_all();
    const std::uint16_t sequence = air.send(2, protocols::kXBeeBroadcast, {7});
    air.run(4000 * kMs);
    for (const std::size_t station : {0u, 1u, 3u, 4u})
        CHECK(air.data_of(station).size() == 1);
    CHECK(air.data_of(2).empty());
    CHECK(fate_of(air, sequence).outcome.delivery == kDelivered);
    air.send(0, protocols::kXBeeBroadcast, {8}, 0, 2);
    air.run(8000 * kMs);
    CHECK(air.data_of(1).size() == 2);
    CHECK(air.data_of(2).size() == 1);
    CHECK(air.data_of(3).size() == 1);
    // MT = 3: the first broadcast and each relay went out four times, 5 stations; the second 2 stations.
    std::uint64_t frames = 0;
    const auto report = air.report();
    for (const auto& station : report["stations"])
        frames += station["mac"]["frames"].get<std::uint64_t>();
    CHECK(frames == 5 * 4 + 2 * 4);
}

TEST_CASE("networks do not hear one another: PAN id and channel") {
    Air air({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}});
    air.settings[1].pan = 0x01B2;
    air.settings[2].channel = 20;
    air.tell_all();
    air.send(0, protocols::kXBeeBroadcast, {1});
    air.run(1000 * kMs);
    CHECK(air.data_of(1).empty());
    CHECK(air.data_of(2).empty());
    CHECK(air.data_of(3).size() == 1);
    // Moved over, it hears.
    air.settings[1].pan = 0x01B5;
    air.tell(1);
    air.send(0, protocols::kXBeeBroadcast, {2});
    air.run(2000 * kMs);
    CHECK(air.data_of(1) == std::vector<std::vector<std::uint8_t>>{{2}});
    // A module that is off hears nothing and sends nothing.
    air.settings[3].on = false;
    air.tell(3);
    air.send(3, protocols::kXBeeBroadcast, {3});
    air.send(0, protocols::kXBeeBroadcast, {4});
    air.run(3000 * kMs);
    CHECK(air.data_of(3).size() == 2);
    CHECK(air.data_of(1).size() == 2);
}

TEST_CASE("loss: MAC retries as often as by independent losses of frame and acknowledgement") {
    const double loss = 0.3;
    Air air({{0, 0, 0}, {1, 0, 0}}, 30.0, loss, 7);
    air.tell_all();
    constexpr int kPackets = 400;
    for (int i = 0; i < kPackets; ++i) {
        // Without the network's acknowledgement, which would come in the retries' way.
        air.send(0, address(1), {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8)}, 1);
        air.run(air.now() + (i == 0 ? 5000 : 200) * kMs);
    }
    air.run(air.now() + 5000 * kMs);
    // With 10 retries nothing is lost; each arrives exactly once.
    CHECK(air.data_of(1).size() == kPackets);
    CHECK(air.fates.size() == kPackets);
    const auto report = air.report();
    const auto& sender = report["stations"]["m0"]["mac"];
    const auto& receiver = report["stations"]["m1"]["mac"];
    // An attempt succeeds with (1 - p)^2; the mean number of attempts is its inverse. Route requests of the
    // first packet (4 frames) are among the sender's frames.
    const double attempts = 1.0 / ((1 - loss) * (1 - loss));
    CHECK((sender["frames"].get<double>() - 4) / kPackets == Approx(attempts).epsilon(0.07));
    CHECK(sender["retries"].get<double>() / kPackets == Approx(attempts - 1).epsilon(0.15));
    // Copies that came because an acknowledgement was lost: p of those received.
    CHECK(receiver["received_twice"].get<double>() / receiver["received"].get<double>() ==
          Approx(loss).margin(0.06));
}

TEST_CASE("all lost: the status reports it, after all retries, and the queue goes on") {
    Air air({{0, 0, 0}, {1, 0, 0}});
    air.settings[0].mac_retries = 2;
    air.tell_all();
    air.send(0, address(1), {1});
    air.run(2000 * kMs);
    air.settings[1].on = false;
    air.tell(1);
    const std::uint16_t lost = air.send(0, address(1), {2});
    air.run(8000 * kMs);
    const Air::Fate& fate = fate_of(air, lost);
    // The known route is broken; it is looked for again, in vain.
    CHECK(fate.outcome.delivery == kNoRoute);
    CHECK(fate.outcome.retries == 1);
    CHECK(air.report()["stations"]["m0"]["mac"]["retries"] == 2);
    CHECK(air.report()["stations"]["m0"]["mac"]["failures"] == 1);
    air.settings[1].on = true;
    air.tell(1);
    const std::uint16_t after = air.send(0, address(1), {3});
    air.run(16000 * kMs);
    CHECK(fate_of(air, after).outcome.delivery == kDelivered);
}

TEST_CASE("two modules with one address: both get what is sent to it, and the report has it") {
    Air air({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    air.settings[2].address = address(1);
    air.tell_all();
    const std::uint16_t sequence = air.send(0, address(1), {5});
    air.run(3000 * kMs);
    CHECK(air.data_of(1).size() == 1);
    CHECK(air.data_of(2).size() == 1);
    CHECK(fate_of(air, sequence).outcome.delivery == kDelivered);
    const auto warnings = air.report()["warnings"];
    REQUIRE(warnings.size() == 1);
    CHECK_THAT(warnings[0].get<std::string>(), Catch::StartsWith("m1 and m2 have one address"));
}

TEST_CASE("nonsense from a module is counted and changes nothing") {
    RandomStream random(3, "nonsense");
    EtherSpec spec;
    spec.stations = {{"a", {0, 0, 0}}, {"b", {1, 0, 0}}};
    EtherNode node(spec);
    for (int round = 0; round < 500; ++round) {
        std::vector<std::uint8_t> octets(1 + random.below(127));
        for (std::uint8_t& octet : octets)
            octet = static_cast<std::uint8_t>(random.next());
        cosim::RadioFrame frame;
        frame.start = round * kMs;
        frame.duration = random.below(2) == 0 ? 0 : kMs;
        frame.octets = cosim::Octets(octets);
        frame.channel = 12;
        std::vector<cosim::Message> inbox{
            {round * kMs, static_cast<cosim::PortIndex>(random.below(2)), frame}};
        std::vector<cosim::Message> outbox;
        node.advance((round + 1) * kMs, inbox, outbox);
        CHECK(outbox.empty());
    }
    const auto report = nlohmann::json::parse(node.finish());
    CHECK(report["stations"]["a"]["bad_frames"].get<int>() +
              report["stations"]["b"]["bad_frames"].get<int>() ==
          500);
    CHECK_THROWS_AS(EtherNode([] {
                        EtherSpec bad;
                        bad.propagation.loss = 1.5;
                        return bad;
                    }()),
                    InputError);
}

TEST_CASE("listening before talking: with CA two that start together hardly collide") {
    const auto collisions = [](std::uint8_t cca) {
        Air air({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 30.0, 0.0, 5);
        for (RadioSettings& settings : air.settings)
            settings.cca = cca;
        air.tell_all();
        for (int i = 0; i < 60; ++i) {
            air.send(1, address(0), std::vector<std::uint8_t>(40, 1), 1);
            air.send(2, address(0), std::vector<std::uint8_t>(40, 2), 1);
            air.run(air.now() + 400 * kMs);
        }
        air.run(air.now() + 5000 * kMs);
        std::size_t delivered = 0;
        for (const Air::Fate& fate : air.fates)
            delivered += fate.outcome.delivery == kDelivered;
        const auto mac = air.report()["stations"]["m0"]["mac"];
        return std::pair(mac["collisions"].get<int>(), delivered);
    };
    const auto deaf = collisions(0), listening = collisions(58);
    CHECK(listening.second == 120);
    CHECK(deaf.first > 60);
    CHECK(listening.first < deaf.first / 4);
}

TEST_CASE("a channel that is never free: status 2 at the earliest promised, and on it goes") {
    // Stations 0 and 1 fill the channel; all hear each other at -40 dBm, above -80 dBm.
    Air air({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, 30.0, 0.0, 2);
    for (std::size_t i = 0; i < 4; ++i) {
        air.settings[i].cca = i < 2 ? 0 : 80;
        air.settings[i].mac_retries = i < 2 ? 10 : 0;
        air.settings[i].repeats = 0;
        air.settings[i].network_retries = 0;
    }
    air.tell_all();
    for (int i = 0; i < 300; ++i) {
        for (std::size_t filler = 0; filler < 2; ++filler)
            for (int k = 0; k < 3; ++k)
                air.send(filler, protocols::kXBeeBroadcast, std::vector<std::uint8_t>(73, 1), 0, 1);
        air.send(2, protocols::kXBeeBroadcast, {1}, 0, 1);
        air.run(air.now() + 11 * kMs);
    }
    air.run(air.now() + 20'000 * kMs);
    CHECK(air.report()["stations"]["m2"]["mac"]["channel_busy"] > 20);
    CHECK(std::count_if(air.fates.begin(), air.fates.end(),
                        [](const Air::Fate& fate) { return fate.station == 2; }) == 300);
}

TEST_CASE("what happens does not depend on how time is granted") {
    const auto life = [](Time step, std::uint8_t cca) {
        Air air({{0, 0, 0}, {15, 0, 0}, {30, 0, 0}, {15, 15, 0}}, 20.0, 0.2, 11);
        for (RadioSettings& settings : air.settings)
            settings.cca = cca;
        air.tell_all();
        RandomStream random(9, "traffic");
        for (int i = 0; i < 60; ++i) {
            const std::size_t from = random.below(4), to = random.below(5);
            air.send(from, to == 4 ? protocols::kXBeeBroadcast : address(to), {static_cast<std::uint8_t>(i)});
            air.run(air.now() + static_cast<Time>(random.below(200)) * kMs, step);
        }
        air.run(air.now() + 5000 * kMs, step);
        std::vector<std::tuple<std::size_t, Time, std::vector<std::uint8_t>>> all;
        for (const auto& one : air.got)
            all.emplace_back(one.station, one.at, one.frame.data);
        for (const auto& one : air.fates)
            all.emplace_back(one.station, one.at, encode(one.outcome));
        return all;
    };
    for (const std::uint8_t cca : std::array<std::uint8_t, 2>{0, 80}) {
        const auto whole = life(cosim::kNever, cca);
        CHECK(whole.size() > 100);
        CHECK(life(kMs / 3, cca) == whole);
        CHECK(life(17 * kMs, cca) == whole);
    }
}

TEST_CASE("a module that goes off while its broadcast waits hears nothing, and no bound breaks") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "off");
        Air air({{0, 0, 0}, {1, 0, 0}}, 30.0, 0.0, seed);
        air.settings[0].repeats = static_cast<std::uint8_t>(random.below(3));
        air.tell_all();
        air.run(10 * kMs);
        for (int i = 0; i < 4; ++i)
            air.send(0, protocols::kXBeeBroadcast, {1, 2, 3});
        air.run(air.now() + 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(30 * kMs))));
        air.settings[0].on = false;
        air.tell(0);
        air.run(air.now() + 1);
        const std::size_t before = air.fates.size();
        air.settings[0].on = true;
        air.run(air.now() + static_cast<Time>(random.below(static_cast<std::uint64_t>(100 * kMs))) + 1);
        air.tell(0);
        air.run(air.now() + 2000 * kMs, 3 * kMs);
        CHECK(air.fates.size() == before);
    }
}

TEST_CASE("a module that changes its channel while its broadcast waits hears that it is through, in time") {
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "channel");
        Air air({{0, 0, 0}, {1, 0, 0}}, 30.0, 0.0, seed);
        air.settings[0].repeats = static_cast<std::uint8_t>(random.below(3));
        air.tell_all();
        air.run(10 * kMs);
        std::vector<std::uint16_t> sent;
        for (int i = 0; i < 4; ++i)
            sent.push_back(air.send(0, protocols::kXBeeBroadcast, {1, 2, 3}));
        air.run(air.now() + 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(30 * kMs))));
        ++air.settings[0].channel;
        if (random.below(2) == 0) ++air.settings[0].pan;
        air.tell(0);
        air.run(air.now() + 3000 * kMs, 2 * kMs);
        for (const std::uint16_t sequence : sent)
            CHECK(fate_of(air, sequence).outcome.delivery == kDelivered);
        CHECK(air.fates.size() == sent.size());
    }
}

TEST_CASE("modules switched, moved to other networks and reset at drawn instants: no bound breaks") {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        CAPTURE(seed);
        RandomStream random(seed, "switched");
        Air air({{0, 0, 0}, {1, 0, 0}, {20, 0, 0}, {40, 0, 0}}, 30.0, 0.1, seed);
        air.tell_all();
        for (int round = 0; round < 120; ++round) {
            const std::size_t station = random.below(4);
            RadioSettings& set = air.settings[station];
            switch (random.below(6)) {
            case 0:
                set.on = !set.on;
                air.tell(station);
                break;
            case 1:
                set.channel = static_cast<std::uint8_t>(12 + random.below(2));
                set.repeats = static_cast<std::uint8_t>(random.below(4));
                set.mac_retries = static_cast<std::uint8_t>(random.below(3));
                set.network_retries = static_cast<std::uint8_t>(random.below(2));
                set.cca = static_cast<std::uint8_t>(random.below(2) == 0 ? 0 : 58);
                air.tell(station);
                break;
            case 2:
                set.address = address(random.below(4));
                air.tell(station);
                break;
            default:
                air.send(station, random.below(2) == 0 ? protocols::kXBeeBroadcast : address(random.below(5)),
                         std::vector<std::uint8_t>(random.below(60), 7));
            }
            air.run(air.now() + static_cast<Time>(random.below(static_cast<std::uint64_t>(40 * kMs))) + 1,
                    1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(5 * kMs))));
        }
    }
}
