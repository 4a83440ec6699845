// A medium that ran ahead and went back is the medium that never did: what it sends, its EOTs and its file of
// frames and its report. Boards that shine at random, bodies that move, are lifted and change their shape; a
// twin is never marked.

#include "physics/ir/ir_node.h"
#include "physics/world/pose_signals.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/physics/ir_worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;
using cosim::Message;
using cosim::PortIndex;
using cosim::Signal;
using cosim::Time;

namespace {

constexpr PortIndex kBoards = 4;
constexpr PortIndex kWorldPort = kBoards;

World lively_world() {
    World world;
    world.arena = rectangular_arena(2, 2);
    for (int i = 0; i < kBoards; ++i)
        world.robots.push_back(rab_robot("r" + std::to_string(i), 0.15 * i, 0.05 * i, i));
    Box box;
    box.name = "box";
    box.x = 0.3;
    box.y = -0.3;
    box.movable = true;
    world.boxes.push_back(box);
    world.parameters = {{"ir.loss", 0.2},
                        {"ir.stray", 0.3},
                        {"ir.spell", 0.3},
                        {"ir.spell_time", 0.02},
                        {"ir.reflection", 0.5}};
    return world;
}

std::vector<Message> random_inbox(RandomStream& random, Time from, Time until, bool scene) {
    std::vector<Message> inbox;
    const auto add = [&](Time at, PortIndex port, std::size_t id, double value) {
        inbox.push_back({at, port, Signal{static_cast<std::uint16_t>(id), value}});
    };
    const SceneSignals ids{kBoards + 1};
    constexpr Time kChip = 98'090'000;
    for (Time at = from;;) {
        at += 1 + static_cast<Time>(random.below(2 * kChip));
        if (at >= until) return inbox;
        const auto board = static_cast<PortIndex>(random.below(kBoards));
        const std::uint64_t what = random.below(scene ? 24 : 20);
        if (what < 14) {
            const double on = random.below(2) == 0 ? 1.0 : 0.0;
            for (std::size_t i = 0; i < kIrSensors; ++i)
                if (random.below(8) != 0) add(at, board, kEmitter + i, on);
        } else if (what < 16) {
            add(at, board, kCarrierId, random.below(4) == 0 ? 0.0 : kFirmwareCarrier);
        } else if (what < 17) {
            add(at, board, kPowerId, static_cast<double>(random.below(256)));
        } else if (what < 20) {
            const auto body = random.below(kBoards + 1);
            add(at, kWorldPort, kPoseSignals * body, random.uniform());
            add(at, kWorldPort, kPoseSignals * body + 1, random.uniform());
            add(at, kWorldPort, kPoseSignals * body + 2, random.uniform());
        } else if (what < 22) {
            add(at, kWorldPort, ids.out(random.below(kBoards + 1)), static_cast<double>(random.below(2)));
        } else {
            const bool fixed = random.below(2) == 0;
            const ShapeValues values =
                values_of(box_shape(random.uniform(), random.uniform(), random.uniform(), 0.1, 0.2,
                                    random.below(3) == 0 ? 0.0 : 0.2, 0.8));
            const std::size_t first = ids.shape(fixed, random.below(fixed ? 4 : 3));
            for (std::size_t i = 0; i < kShapeSignals; ++i)
                add(at, kWorldPort, first + i, values[i]);
        }
    }
}

bool same_future(const IrNode& a, const IrNode& b) {
    for (PortIndex port = 0; port <= kWorldPort; ++port)
        if (a.earliest_output(port) != b.earliest_output(port) || a.lookahead(port) != b.lookahead(port))
            return false;
    return true;
}

}  // namespace

TEST_CASE("the medium goes back") {
    for (const bool scene : {false, true}) {
        INFO((scene ? "a changing scene" : "a fixed scene"));
        RandomStream random(3, scene ? "scene" : "fixed");
        const std::string file = puckloop::tests::scratch_path("ir.csv").string();
        const std::string twin_file = puckloop::tests::scratch_path("twin.csv").string();
        IrNode node(lively_world(), {"ir", file, scene});
        IrNode twin(lively_world(), {"ir", twin_file, scene});
        REQUIRE(node.rewindable() != nullptr);
        cosim::Rewindable& back = *node.rewindable();
        const auto longest = [&] { return Time{1} + static_cast<Time>(random.below(4'000'000'000)); };
        std::size_t sent_in_all = 0;
        Time now = 0;
        for (int i = 0; i < 250; ++i) {
            INFO("mark " << i);
            back.mark();
            const std::string text = tests::text_of(file);
            for (std::uint64_t times = random.below(3); times > 0; --times) {
                Time ahead = now;
                for (std::uint64_t steps = 1 + random.below(3); steps > 0; --steps) {
                    const Time until = ahead + longest();
                    std::vector<Message> sent;
                    node.advance(until, random_inbox(random, ahead, until, scene), sent);
                    ahead = until;
                }
                CHECK(tests::text_of(file) == text);
                back.rewind();
                REQUIRE(same_future(node, twin));
            }
            if (random.below(2) == 0) back.settle();
            const Time until = now + longest();
            const auto inbox = random_inbox(random, now, until, scene);
            std::vector<Message> sent, expected;
            node.advance(until, inbox, sent);
            twin.advance(until, inbox, expected);
            const bool same = sent == expected;
            REQUIRE(same);
            REQUIRE(same_future(node, twin));
            sent_in_all += sent.size();
            now = until;
        }
        CHECK(sent_in_all > 3000);
        CHECK(node.finish() == twin.finish());
        CHECK(tests::text_of(file) == tests::text_of(twin_file));
        std::filesystem::remove(file);
        std::filesystem::remove(twin_file);
    }
}
