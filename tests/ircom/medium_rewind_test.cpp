// A medium that ran ahead and went back is the medium that never did: messages, EOTs, lookaheads, the file of
// words, the report. Lines that switch at random, things that move, are lifted and change their shape.

#include "base/random.h"
#include "physics/ircom/ircom_node.h"
#include "physics/world/pose_signals.h"
#include "protocols/infrared/ircom.h"
#include "tests/ircom/faults.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::ircom_test;
using namespace puckloop::physics;

namespace {

constexpr PortIndex kRobots = 3, kDevices = kRobots + 1;

World lively_world() {
    World description = world();
    for (int i = 0; i < kRobots; ++i)
        add_robot(description, "r" + std::to_string(i), 0.15 * i, 0.05 * i, i);
    add_booth(description, "booth", -0.5, -0.5, 0.4);
    Box box;
    box.name = "box";
    box.x = 0.3;
    box.y = -0.3;
    box.movable = true;
    description.boxes.push_back(box);
    return description;
}

std::vector<Message> random_inbox(RandomStream& random, Time from, Time until, bool scene) {
    std::vector<Message> inbox;
    const auto add = [&](Time at, PortIndex port, std::size_t id, double value) {
        inbox.push_back({at, port, Signal{static_cast<std::uint16_t>(id), value}});
    };
    const SceneSignals ids{kRobots + 1};
    for (Time at = from;;) {
        at += 1 + static_cast<Time>(random.below(1'000'000'000));
        if (at >= until) break;
        if (random.below(60) == 0) {
            // A whole word of a robot's.
            const auto symbols = protocols::ircom_symbols(static_cast<std::uint8_t>(random.below(256)));
            const auto robot = static_cast<PortIndex>(random.below(kRobots));
            for (const auto& edge : protocols::ircom_edges(symbols))
                if (at + edge.time < until)
                    for (const auto id : kIds.pulse)
                        add(at + edge.time, robot, id, edge.lit ? 1.0 : 0.0);
            continue;
        }
        const auto device = static_cast<PortIndex>(random.below(kDevices));
        const std::uint64_t what = random.below(scene ? 22 : 18);
        const double on = random.below(2) == 0 ? 1.0 : 0.0;
        if (what < 14) {
            if (device == kRobots)
                add(at, device, kIds.emit, on);
            else
                for (const auto id : kIds.pulse)
                    if (random.below(4) != 0) add(at, device, id, on);
        } else if (what < 18) {
            const auto body = random.below(kRobots + 1);
            const bool far = random.below(3) == 0;
            add(at, kDevices, kPoseSignals * body, far ? 0.9 : 0.4 * random.uniform() - 0.55);
            add(at, kDevices, kPoseSignals * body + 1, 0.4 * random.uniform() - 0.55);
            add(at, kDevices, kPoseSignals * body + 2, random.uniform());
        } else if (what < 20) {
            add(at, kDevices, ids.out(random.below(kRobots + 1)), static_cast<double>(random.below(2)));
        } else {
            const bool fixed = random.below(2) == 0;
            const ShapeValues values =
                values_of(box_shape(random.uniform(), random.uniform(), random.uniform(), 0.1, 0.2,
                                    random.below(3) == 0 ? 0.0 : 0.2, 0.8));
            const std::size_t first = ids.shape(fixed, random.below(fixed ? 4 : 3));
            for (std::size_t i = 0; i < kShapeSignals; ++i)
                add(at, kDevices, first + i, values[i]);
        }
    }
    std::stable_sort(inbox.begin(), inbox.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return inbox;
}

/// Each kind, for some of the words.
std::vector<cosim::CarriedFault> every_fault() {
    std::vector<cosim::FaultSpec> specs;
    for (const cosim::KindInfo& kind : cosim::all_kinds()) {
        if (kind.place != cosim::PlaceKind::Ircom) continue;
        specs.push_back(ircom_fault(std::string(kind.name)));
        if (kind.name == "jitter") specs.back().set("jitter", 30e-6);
        if (kind.name == "delay") specs.back().set("delay", 0.05);
        specs.back().probability = 0.4;
    }
    return carried(specs);
}

}  // namespace

TEST_CASE("IRcom's medium goes back, and keeps what it promised of its ports") {
    for (const bool faults : {false, true})
        for (const bool scene : {false, true}) {
            INFO((scene ? "a changing scene" : "a fixed scene") << (faults ? ", faults" : ""));
            RandomStream random(3, scene ? "scene" : "fixed");
            const std::string file = puckloop::tests::scratch_path("ircom.csv").string();
            const std::string twin_file = puckloop::tests::scratch_path("twin.csv").string();
            IrcomNode node(lively_world(),
                           {"ircom", kIds, file, scene, faults ? every_fault() : decltype(every_fault()){}});
            IrcomNode twin(lively_world(), {"ircom", kIds, twin_file, scene,
                                            faults ? every_fault() : decltype(every_fault()){}});
            cosim::Rewindable& back = *node.rewindable();
            const auto longest = [&] { return Time{1} + static_cast<Time>(random.below(40'000'000'000)); };
            std::size_t sent_in_all = 0;
            Time now = 0;
            for (int i = 0; i < 300; ++i) {
                INFO("mark " << i);
                back.mark();
                for (std::uint64_t times = random.below(3); times > 0; --times) {
                    Time ahead = now;
                    for (std::uint64_t steps = 1 + random.below(3); steps > 0; --steps) {
                        const Time until = ahead + longest();
                        std::vector<Message> wasted;
                        node.advance(until, random_inbox(random, ahead, until, scene), wasted);
                        ahead = until;
                    }
                    back.rewind();
                }
                const Time until = now + longest();
                const auto inbox = random_inbox(random, now, until, scene);
                // What was promised before: nothing sooner than EOT, or than a message in and the lookahead.
                std::vector<Time> earliest, lookahead;
                for (PortIndex port = 0; port < kDevices; ++port) {
                    earliest.push_back(twin.earliest_output(port));
                    lookahead.push_back(twin.lookahead(port));
                }
                std::vector<Message> sent, expected;
                if (!inbox.empty()) {
                    // Up to the first message only: lookaheads change with each.
                    const Time first = inbox.front().time;
                    std::vector<Message> head;
                    std::copy_if(inbox.begin(), inbox.end(), std::back_inserter(head),
                                 [&](const Message& m) { return m.time == first; });
                    twin.advance(first + 1, head, expected);
                    twin.advance(until, std::span(inbox).subspan(head.size()), expected);
                    for (const Message& message : expected)
                        CHECK(message.time >=
                              std::min(earliest[message.port], cosim::later(first, lookahead[message.port])));
                } else {
                    twin.advance(until, inbox, expected);
                    for (const Message& message : expected)
                        CHECK(message.time >= earliest[message.port]);
                }
                node.advance(until, inbox, sent);
                const auto order = [](const Message& a, const Message& b) {
                    return std::pair(a.time, a.port) < std::pair(b.time, b.port);
                };
                std::stable_sort(sent.begin(), sent.end(), order);
                std::stable_sort(expected.begin(), expected.end(), order);
                REQUIRE(sent == expected);
                for (PortIndex port = 0; port < kDevices; ++port) {
                    REQUIRE(node.earliest_output(port) == twin.earliest_output(port));
                    REQUIRE(node.lookahead(port) == twin.lookahead(port));
                }
                sent_in_all += sent.size();
                now = until;
            }
            back.settle();
            CHECK(sent_in_all > 1000);
            CHECK(node.finish() == twin.finish());
            CHECK(tests::text_of(file) == tests::text_of(twin_file));
            CHECK(tests::text_of(file).size() > 200);
            const auto report = nlohmann::json::parse(twin.finish());
            int fired = 0;
            for (std::size_t f = 0; faults && f < report["faults"].size(); ++f)
                fired += report["faults"][f]["fired"].get<int>();
            CHECK((fired > 5) == faults);
        }
}
