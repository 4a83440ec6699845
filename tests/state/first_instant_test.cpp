// A fault that begins at the very instant of a loaded state does what it does in a board that was never
// saved: of every kind, in a main board and a range-and-bearing board, after a snapshot, a boot from the
// cache, and having gone back.

#include "cosim/resume/resumed_node.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/node_under_test.h"
#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;

namespace {

constexpr Time kAt = 210 * kMillisecond, kBehind = 40 * kMillisecond;

std::unique_ptr<cosim::StatefulNode> make_board(bool rab, const std::vector<cosim::CarriedFault>& faults) {
    if (rab) {
        rab::RabNodeOptions options;
        options.board.name = "robot0.rab";
        options.faults = faults;
        return std::make_unique<rab::RabNode>(own_rab_image(), options);
    }
    pic::PicNodeOptions options;
    options.board.name = "robot0.pic";
    options.faults = faults;
    return std::make_unique<pic::PicNode>(own_pic_image(), options);
}

/// Each kind once; those of a board that has not what they harm are left out.
std::vector<cosim::FaultSpec> kinds(bool rab) {
    std::vector<cosim::FaultSpec> all{
        board_fault("reset").set("cause", "mclr"),
        board_fault("reset").set("cause", "power_on"),
        board_fault("hang").set("duration", 0.01),
        board_fault("brown_out").set("duration", 0.01),
        board_fault("flip").set("space", "ram"),
        board_fault("flip").set("space", "register"),
        board_fault("interrupt").set("vector", "T1"),
        board_fault("lost_interrupt").set("vector", "T1"),
        board_fault("late_interrupt").set("vector", "T1").set("delay", 1e-4),
        board_fault("clock").set("ppm", 900.0),
        board_fault("sag").set("volts", 1.5),
        board_fault("sag").set("volts", 3.9),
        board_fault("battery").set("profile", "0 s 1.2 V, 0.02 s 4 V"),
        board_fault("adc_noise").set("channel", rab ? 20.0 : 8.0).set("sigma", 0.2),
    };
    if (rab) {
        all.push_back(board_fault("foreign_carrier").set("receiver", 0.0));
        all.push_back(board_fault("emitter_dead").set("emitter", 0.0));
        all.push_back(board_fault("receiver_dead").set("receiver", 0.0));
    } else {
        all.push_back(board_fault("ambient_burst").set("sensor", 0.0).set("strength", 1.0));
        all.push_back(board_fault("phase_open").set("motor", "left").set("winding", 1.0));
        all.push_back(board_fault("wheel_stall").set("motor", "right"));
    }
    for (cosim::FaultSpec& spec : all) {
        spec.begin = kAt;
        spec.end = kAt + kBehind / 2;
        spec.count = spec.kind == "flip" || spec.kind == "reset" || spec.kind == "hang" ||
                             spec.kind == "brown_out" || spec.kind == "interrupt"
                         ? 1
                         : spec.count;
    }
    return all;
}

Stretch inputs(bool rab, Time from, Time until, std::uint64_t seed) {
    RandomStream random(seed, "first instant");
    Stretch stretch = random_stretch(random, from, until, 2000, rab ? kRabSignals : kPicSignals);
    // The supply itself is the fault's affair.
    std::erase_if(stretch.inbox, [&](const Message& message) {
        const auto* signal = std::get_if<cosim::Signal>(&message.payload);
        return signal != nullptr && rab && signal->id >= 50;
    });
    return stretch;
}

}  // namespace

TEST_CASE("a fault of the first instant behind a loaded state does what it does in a whole run") {
    const bool rab = GENERATE(false, true);
    const Stretch first = inputs(rab, 0, kAt, 1), then = inputs(rab, kAt, kAt + kBehind, 2);
    const auto plain = make_board(rab, {});
    run(*plain, first);
    const std::vector<std::uint8_t> state = saved(*plain);
    for (const cosim::FaultSpec& spec : kinds(rab)) {
        INFO((rab ? "range-and-bearing board: " : "main board: ")
             << spec.kind << " " << spec.parameters.text("cause") << spec.parameters.text("space"));
        const std::vector<cosim::CarriedFault> faults{carried(spec)};
        const auto whole = make_board(rab, faults);
        run(*whole, first);
        const std::vector<Message> expected = run(*whole, then);

        const auto fresh = loaded([&] { return make_board(rab, faults); }, state);
        const bool same = run(*fresh, then) == expected;
        CHECK(same);

        // The same once more, gone back to that instant after having run ahead of it.
        const auto again = loaded([&] { return make_board(rab, faults); }, state);
        cosim::Rewindable& back = *again->rewindable();
        for (int times = 0; times < 2; ++times) {
            back.mark();
            run(*again, inputs(rab, kAt, kAt + kBehind / 3, 3));
            back.rewind();
        }
        back.settle();
        const bool same_again = run(*again, then) == expected;
        CHECK(same_again);
    }
}

TEST_CASE("a fault that held in the saved run and is in none of the next ends at once, and nothing crashes") {
    const bool rab = GENERATE(false, true);
    const Stretch first = inputs(rab, 0, kAt, 1);
    for (cosim::FaultSpec spec : kinds(rab)) {
        INFO(spec.kind);
        spec.begin = kAt / 2;
        spec.end = 2 * kAt;
        const auto harmed = make_board(rab, {carried(spec)});
        run(*harmed, first);
        const auto free = loaded([&] { return make_board(rab, {}); }, saved(*harmed));
        const Stretch then = inputs(rab, kAt, kAt + kBehind, 2);
        run(*free, then);
        // And with grants cut elsewhere the same.
        const auto other = loaded([&] { return make_board(rab, {}); }, saved(*harmed));
        const auto third = loaded([&] { return make_board(rab, {}); }, saved(*harmed));
        Stretch whole = then;
        whole.cuts = {then.until};
        const bool same = run(*other, whole) == run(*third, then);
        CHECK(same);
    }
}

TEST_CASE("a battery's profile goes on with the step that it was saved in") {
    const bool rab = GENERATE(false, true);
    // From below each brown-out threshold to above it, wherever in a step the state is saved.
    for (const Time before : {3'300'000'000, 10'700'000'000, 17'900'000'000}) {
        INFO((rab ? "range-and-bearing board, " : "main board, ") << before << " ps");
        cosim::FaultSpec spec = board_fault("battery").set("profile", "0 s 0.4 V, 0.04 s 4 V");
        spec.begin = kAt - before;
        spec.end = kAt + 4 * kBehind;
        const std::vector<cosim::CarriedFault> faults{carried(spec)};
        const Stretch first = inputs(rab, 0, kAt, 1), then = inputs(rab, kAt, kAt + 4 * kBehind, 2);
        const auto whole = make_board(rab, faults);
        run(*whole, first);
        const auto fresh = loaded([&] { return make_board(rab, faults); }, saved(*whole));
        const bool same = run(*fresh, then) == run(*whole, then);
        CHECK(same);
    }
}

TEST_CASE("a fault of the first instant behind a boot from the cache does what it does in a whole run") {
    const bool rab = GENERATE(false, true);
    const Stretch first = inputs(rab, 0, kAt, 1), then = inputs(rab, kAt, kAt + kBehind, 2);
    cosim::BoardState boot;
    {
        cosim::ResumeOptions options;
        options.save_at = kAt;
        options.save = [&](cosim::BoardState state) {
            boot = std::move(state);
            return std::string();
        };
        cosim::ResumedNode node([&] { return make_board(rab, {}); }, options);
        run(node, first);
        std::vector<Message> ignored;
        node.advance(kAt + 1, {}, ignored);
    }
    REQUIRE(boot.time == kAt);
    for (const cosim::FaultSpec& spec : kinds(rab)) {
        INFO(spec.kind);
        const std::vector<cosim::CarriedFault> faults{carried(spec)};
        const auto whole = make_board(rab, faults);
        std::vector<Message> expected = run(*whole, first);
        const std::vector<Message> more = run(*whole, then);
        expected.insert(expected.end(), more.begin(), more.end());
        cosim::ResumeOptions options;
        options.from = boot;
        options.fall_back = true;
        cosim::ResumedNode node([&] { return make_board(rab, faults); }, options);
        std::vector<Message> sent = run(node, first);
        const std::vector<Message> behind = run(node, then);
        sent.insert(sent.end(), behind.begin(), behind.end());
        const auto by_time = [](const Message& a, const Message& b) {
            return std::pair(a.time, a.port) < std::pair(b.time, b.port);
        };
        std::stable_sort(sent.begin(), sent.end(), by_time);
        std::stable_sort(expected.begin(), expected.end(), by_time);
        const bool same = sent == expected;
        CHECK(same);
    }
}
