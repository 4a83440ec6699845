// Faults of the light between range-and-bearing boards: chips, edges, weak parts, occlusion, ambient bursts;
// each hits what it is for and nothing else, and reports it.

#include "base/error.h"
#include "base/json.h"
#include "physics/ir/ir_node.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <map>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::FaultSpec;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Message;
using cosim::PortIndex;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr Time kChip = 98'090'000;
constexpr Time kDelay = 20 * kMicrosecond;
constexpr Time kStart = 10 * kMillisecond, kPeriod = 12 * kMillisecond;
const std::string kChips = "1111110101100110100101011001011001010110011010";

FaultSpec fault(const std::string& kind, const std::string& robot, const std::string& from = {}) {
    FaultSpec spec;
    spec.kind = kind;
    spec.name = "fault";
    spec.link = robot + ".ir";
    spec.node = "ir";
    spec.from = from;
    return spec;
}

/// a in the middle looking at b; c behind a, and d to its left.
World square() {
    World world = ideal_pair(0.2);
    world.parameters["ir.baseline"] = 0.0;
    world.parameters["ir.ambient"] = 0.0;
    world.robots.push_back(rab_robot("c", -0.27, 0));
    world.robots.push_back(rab_robot("d", 0, 0.27));
    return world;
}
constexpr PortIndex kA = 0, kB = 1, kC = 2, kD = 3;

void switch_all(std::vector<Message>& messages, Time at, PortIndex board, bool on) {
    for (std::uint16_t i = 0; i < kIrSensors; ++i)
        messages.push_back({at, board, Signal{static_cast<std::uint16_t>(kEmitter + i), on ? 1.0 : 0.0}});
}

/// `frames` of `sender`, which may be a hair early or late at each edge.
std::vector<Message> talk(PortIndex sender, int frames, RandomStream& random) {
    std::vector<Message> messages{{kMicrosecond, sender, Signal{kCarrierId, kFirmwareCarrier}},
                                  {kMicrosecond, sender, Signal{kPowerId, 115}}};
    for (int frame = 0; frame < frames; ++frame) {
        bool on = false;
        for (std::size_t i = 0; i <= kChips.size(); ++i) {
            const bool next = i < kChips.size() && kChips[i] == '1';
            const Time hair = i == 0 ? 0 : static_cast<Time>(random.below(800'000)) - 400'000;
            if (next != on)
                switch_all(messages, kStart + frame * kPeriod + static_cast<Time>(i) * kChip + hair, sender,
                           next);
            on = next;
        }
    }
    return messages;
}

struct Heard {
    std::vector<Message> out;
    nlohmann::json faults;

    /// Does any demodulator of `board` show a carrier then?
    bool lit(PortIndex board, Time at) const {
        std::array<bool, kIrSensors> on{};
        for (const Message& message : out)
            if (const auto& signal = std::get<Signal>(message.payload);
                message.port == board && signal.id < kPeak && message.time <= at)
                on[signal.id - kDemod] = signal.value != 0.0;
        return std::find(on.begin(), on.end(), true) != on.end();
    }
    /// Chips of a frame as read in their middles.
    std::string chips(PortIndex board, int frame) const {
        std::string seen;
        for (std::size_t i = 0; i < kChips.size(); ++i)
            seen += lit(board, kStart + frame * kPeriod + static_cast<Time>(i) * kChip + kChip / 2 + kDelay)
                        ? '1'
                        : '0';
        return seen;
    }
    /// The highest level that a board shows from `from` on, before `until`.
    double level(PortIndex board, Time from, Time until) const {
        double highest = 0.0;
        for (const Message& message : out)
            if (const auto& signal = std::get<Signal>(message.payload);
                message.port == board && signal.id >= kPeak && signal.id < kEmitter && message.time >= from &&
                message.time < until)
                highest = std::max(highest, signal.value);
        return highest;
    }
};

Heard hear(const World& world, const std::vector<FaultSpec>& specs, const std::vector<Message>& messages,
           Time until, RandomStream* cuts = nullptr) {
    IrNodeOptions options;
    for (std::size_t i = 0; i < specs.size(); ++i)
        options.faults.push_back({specs[i], cosim::Trigger(specs[i], cosim::fault_stream(specs[i], 5, i))});
    IrNode node(world, options);
    Heard heard;
    auto next = messages.begin();
    const auto take = [&](Time end) {
        const auto first = next;
        while (next != messages.end() && next->time < end)
            ++next;
        return std::vector<Message>(first, next);
    };
    for (Time now = 0; now < until;) {
        const Time end =
            cuts != nullptr ? std::min(until, now + 1 + static_cast<Time>(cuts->below(3 * kChip))) : until;
        if (cuts != nullptr && cuts->below(4) == 0) {  // ahead, and back
            const auto before = next;
            std::vector<Message> nobody;
            node.rewindable()->mark();
            const Time ahead = end + static_cast<Time>(cuts->below(4 * kChip));
            node.advance(ahead, take(ahead), nobody);
            node.rewindable()->rewind();
            node.rewindable()->settle();
            next = before;
        }
        const auto inbox = take(end);
        std::array<Time, 4> earliest{};
        for (PortIndex port = 0; port < 4; ++port)
            earliest[port] =
                std::min(node.earliest_output(port),
                         inbox.empty() ? cosim::kNever : cosim::later(inbox[0].time, node.lookahead(port)));
        std::vector<Message> out;
        node.advance(end, inbox, out);
        for (const Message& message : out)
            REQUIRE(message.time >= earliest[message.port]);
        heard.out.insert(heard.out.end(), out.begin(), out.end());
        now = end;
    }
    std::stable_sort(heard.out.begin(), heard.out.end(), [](const Message& a, const Message& b) {
        return std::pair(a.port, a.time) < std::pair(b.port, b.time);
    });
    const auto report = nlohmann::json::parse(node.finish());
    if (report.contains("faults")) heard.faults = report["faults"];
    return heard;
}

std::string inverted(std::string chips, std::size_t chip) {
    chips[chip] = chips[chip] == '1' ? '0' : '1';
    return chips;
}

}  // namespace

TEST_CASE("single chips of a frame are inverted, on the way out or in") {
    RandomStream random(1, "chip flips");
    const std::vector<Message> messages = talk(kA, 3, random);
    const Time end = kStart + 3 * kPeriod;
    const Heard sound = hear(square(), {}, messages, end);
    for (const PortIndex board : {kB, kC, kD})
        for (int frame = 0; frame < 3; ++frame)
            REQUIRE(sound.chips(board, frame) == kChips);
    for (int i = 0; i < 12; ++i) {
        const auto chip = static_cast<std::size_t>(random.below(kChips.size()));
        const bool out = i % 2 == 0;
        FaultSpec spec = out ? fault("chip_flip", "a", "a.rab") : fault("chip_flip", "c", "ir");
        spec.set("chip", static_cast<double>(chip));
        spec.skip = 1;
        spec.count = 1;  // in the second frame
        const Heard heard = hear(square(), {spec}, messages, end);
        INFO("chip " << chip << (out ? " sent" : " arriving"));
        for (const PortIndex board : {kB, kC, kD})
            for (int frame = 0; frame < 3; ++frame) {
                const bool hit = frame == 1 && (out || board == kC);
                CHECK(heard.chips(board, frame) == (hit ? inverted(kChips, chip) : kChips));
            }
        CHECK(heard.faults.at(0).at("fired") == 1);
        const auto& firing = heard.faults.at(0).at("firings").at(0);
        CHECK(firing.at(1) == 1);  // the frame
        const Time at = firing.at(0);
        CHECK(std::abs(at - (kStart + kPeriod + static_cast<Time>(chip) * kChip)) < kMicrosecond);
        CHECK(firing.at(2) == (out ? "a" : "a to c") + (" chip " + std::to_string(chip)));
    }
    // Any chip, each with its own luck.
    FaultSpec some = fault("chip_flip", "a", "a.rab");
    some.probability = 0.05;
    const Heard heard = hear(square(), {some}, messages, end);
    std::size_t wrong = 0;
    for (int frame = 0; frame < 3; ++frame) {
        const std::string seen = heard.chips(kB, frame);
        for (std::size_t k = 0; k < seen.size(); ++k)
            wrong += seen[k] != kChips[k];
    }
    const std::size_t fired = heard.faults.at(0).at("fired");
    CHECK(wrong > 0);
    CHECK(fired >= wrong);
    CHECK(fired <= wrong + 3);  // behind a frame's last light one chip may light up
}

TEST_CASE("edges come late by up to the jitter, in their order") {
    RandomStream random(2, "chip jitter");
    const std::vector<Message> messages = talk(kA, 2, random);
    const Time end = kStart + 2 * kPeriod;
    const Heard sound = hear(square(), {}, messages, end);
    FaultSpec spec = fault("chip_jitter", "b", "ir").set("jitter", 30e-6);
    const Heard heard = hear(square(), {spec}, messages, end);
    const auto edges = [](const Heard& run, PortIndex board) {
        std::vector<Time> times;
        for (const Message& message : run.out)
            if (message.port == board && std::get<Signal>(message.payload).id == kDemod + 0)
                times.push_back(message.time);
        return times;
    };
    for (const PortIndex board : {kC, kD})
        CHECK(edges(heard, board) == edges(sound, board));
    Time most = 0;
    std::size_t compared = 0;
    for (std::uint16_t k = 0; k < kIrSensors; ++k) {
        std::vector<Time> before, after;
        for (const auto& [run, times] : {std::pair(&sound, &before), std::pair(&heard, &after)})
            for (const Message& message : run->out)
                if (message.port == kB && std::get<Signal>(message.payload).id == kDemod + k)
                    times->push_back(message.time);
        REQUIRE(before.size() == after.size());
        for (std::size_t n = 0; n < before.size(); ++n, ++compared) {
            CHECK(after[n] >= before[n]);
            most = std::max(most, after[n] - before[n]);
        }
    }
    CHECK(compared > 100);
    CHECK(most > 25 * kMicrosecond);
    CHECK(most <= 30 * kMicrosecond);
    CHECK(heard.faults.at(0).at("fired") == 2 * 30);
}

TEST_CASE("weak parts, occlusion and ambient light") {
    RandomStream random(3, "weak parts");
    const std::vector<Message> messages = talk(kA, 3, random);
    const Time end = kStart + 3 * kPeriod;
    const std::string dark(kChips.size(), '0');
    const Heard sound = hear(square(), {}, messages, end);
    const auto frame_level = [&](const Heard& run, PortIndex board, int frame) {
        return run.level(board, kStart + frame * kPeriod, kStart + (frame + 1) * kPeriod);
    };
    const auto second_only = [&](FaultSpec spec) {
        spec.begin = kStart + kPeriod / 2;
        spec.count = 1;
        return hear(square(), {spec}, messages, end);
    };
    SECTION("emitters") {
        const Heard weak = second_only(fault("weak_emitter", "a").set("gain", 0.5));
        CHECK(frame_level(weak, kB, 0) == frame_level(sound, kB, 0));
        CHECK(frame_level(weak, kB, 1) == Approx(frame_level(sound, kB, 1) / 2).margin(1));
        CHECK(weak.chips(kB, 1) == kChips);
        CHECK(weak.faults.at(0).at("firings").at(0).at(1) == 1);
        const Heard gone = second_only(fault("weak_emitter", "a").set("gain", 0.0));
        for (const PortIndex board : {kB, kC, kD}) {
            CHECK(gone.chips(board, 0) == kChips);
            CHECK(gone.chips(board, 1) == dark);
            CHECK(gone.chips(board, 2) == kChips);
        }
    }
    SECTION("receivers") {
        const Heard weak = second_only(fault("weak_receiver", "d").set("gain", 0.3));
        CHECK(frame_level(weak, kD, 1) == Approx(0.3 * frame_level(sound, kD, 1)).margin(1));
        CHECK(frame_level(weak, kB, 1) == frame_level(sound, kB, 1));
        CHECK(second_only(fault("weak_receiver", "d").set("gain", 1e-6)).chips(kD, 1) == dark);
        // One of the twelve: those that point at a.
        FaultSpec one = fault("weak_receiver", "b").set("gain", 0.0).set("receiver", 1);
        CHECK(hear(square(), {one}, messages, end).chips(kB, 1) == kChips);
    }
    SECTION("occlusion") {
        const Heard between = second_only(fault("occlusion", "a").set("other", "c"));
        CHECK(between.chips(kC, 1) == dark);
        CHECK(between.chips(kC, 2) == kChips);
        CHECK(between.chips(kB, 1) == kChips);
        CHECK(between.faults.at(0).at("firings").at(0).at(2) == "a to c");
        FaultSpec sector = fault("occlusion", "a").set("bearing", 90).set("width", 40);
        const Heard left = hear(square(), {sector}, messages, end);
        CHECK(left.chips(kD, 1) == dark);
        CHECK(left.chips(kB, 1) == kChips);
        CHECK(left.chips(kC, 1) == kChips);
        CHECK(left.faults.at(0).at("fired") == 3);
        FaultSpec in = fault("occlusion", "d", "ir").set("other", "b");
        CHECK(hear(square(), {in}, messages, end).faults.at(0).at("fired") == 0);
    }
    SECTION("ambient light") {
        FaultSpec burst = fault("ambient_burst", "b").set("level", 3000).set("gain", 0.0);
        burst.begin = kStart + kPeriod - kMillisecond;
        burst.end = kStart + 2 * kPeriod - kMillisecond;
        const Heard run = hear(square(), {burst}, messages, end);
        CHECK(run.chips(kB, 0) == kChips);
        CHECK(run.chips(kB, 1) == dark);
        CHECK(run.chips(kB, 2) == kChips);
        CHECK(run.chips(kC, 1) == kChips);
        CHECK(run.level(kB, burst.begin, burst.end) >= 3000);
        CHECK(run.faults.at(0).at("fired") == 2);  // the light, and a frame that it swallowed
        CHECK(run.faults.at(0).at("firings").at(0).at(0) == burst.begin);
        CHECK(run.faults.at(0).at("firings").at(1).at(2) == "a to b");
        // In the midst of a frame.
        burst.begin = kStart + 20 * kChip;
        const std::string cut = hear(square(), {burst}, messages, end).chips(kB, 0);
        CHECK(cut.substr(0, 20) == kChips.substr(0, 20));
        CHECK(cut.substr(21) == std::string(kChips.size() - 21, '0'));
    }
}

TEST_CASE("faults of light do not depend on cuts, nor on going back") {
    RandomStream random(4, "light and cuts");
    std::size_t fired = 0;
    for (int i = 0; i < 6; ++i) {
        std::vector<Message> messages = talk(kA, 3, random);
        for (const PortIndex board : {kB, kD}) {
            auto more = talk(board, 2, random);
            for (Message& message : more)
                message.time += board * 3 * kMillisecond;
            messages.insert(messages.end(), more.begin(), more.end());
        }
        std::stable_sort(messages.begin(), messages.end(),
                         [](const Message& a, const Message& b) { return a.time < b.time; });
        std::vector<FaultSpec> specs;
        const auto add = [&](FaultSpec spec) {
            spec.name += std::to_string(specs.size());
            spec.begin = static_cast<Time>(random.below(kStart + kPeriod));
            if (random.below(2) == 0)
                spec.end = spec.begin + 1 + static_cast<Time>(random.below(2 * kPeriod));
            spec.probability = spec.kind == "ambient_burst" ? 1.0 : 0.3;
            specs.push_back(spec);
        };
        add(fault("chip_flip", "a"));
        add(fault("chip_flip", "c", "ir"));
        add(fault("chip_jitter", "d").set("jitter", 200e-6));
        add(fault("chip_jitter", "b", "b.rab").set("jitter", 20e-6));
        add(fault("weak_emitter", "b").set("gain", 0.1).set("emitter", 3));
        add(fault("weak_receiver", "a").set("gain", 0.5));
        add(fault("occlusion", "d"));
        add(fault("ambient_burst", "a").set("gain", 0.0).set("level", 100));
        const Time end = kStart + 4 * kPeriod;
        World world = square();
        world.parameters["ir.frame_noise"] = 0.1;
        world.parameters["ir.self_coupling"] = 0.5;
        const Heard whole = hear(world, specs, messages, end);
        const Heard cut = hear(world, specs, messages, end, &random);
        const bool same = whole.out == cut.out;
        CHECK(same);
        CHECK(whole.faults == cut.faults);
        for (const auto& one : whole.faults)
            fired += one.at("fired").get<std::size_t>();
    }
    CHECK(fired > 100);
}

TEST_CASE("light that a fault cannot hit is refused") {
    const auto refused = [](const FaultSpec& spec, const std::string& what) {
        CHECK_THROWS_WITH(hear(square(), {spec}, {}, kMillisecond), Catch::Contains(what));
    };
    refused(fault("chip_flip", "z"), "no range-and-bearing board on 'z' (expected a, b, c, d)");
    refused(fault("occlusion", "a").set("other", "nobody"), "no range-and-bearing board on 'nobody'");
    refused(fault("occlusion", "a").set("bearing", 20), "a sector without width");
    refused(fault("weak_emitter", "a", "ir").set("gain", 0.5), "weak_emitter from ir");
}
