// A board that ran ahead and went back is the board that never did: messages, promises, log, report and every
// byte of its saved state. Own firmware, real images (PUCKLOOP_IMAGES) and random programs, marked at random
// times; a twin that is never marked gets the same grants and messages.

#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/files.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/scratch.h"
#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::Message;
using cosim::Time;

namespace {

using MakeLogged = std::function<std::unique_ptr<cosim::StatefulNode>(const std::string& log)>;

MakeLogged logged_pic(const image::Image& image, bool linked = true) {
    return [image, linked](const std::string& log) {
        pic::PicNodeOptions options;
        options.board.name = "robot0.pic";
        options.board.crystal_ppm = -23;
        options.i2c_linked = linked;
        options.log = log;
        options.resets = {30 * cosim::kMillisecond, 95 * cosim::kMillisecond};
        return std::make_unique<pic::PicNode>(image, options);
    };
}

MakeLogged logged_rab(const image::Image& image) {
    return [image](const std::string& log) {
        rab::RabNodeOptions options;
        options.board.name = "robot0.rab";
        options.log = log;
        return std::make_unique<rab::RabNode>(image, options);
    };
}

struct Plan {
    int marks = 60;
    Time between = 0;  ///< longest time from one mark to the next
    Time ahead = 0;    ///< longest time run ahead
    double busy = 300;
    bool rab = false;
};

/// A transfer on the bus of the robot: the master asks for a register or writes one.
void add_transfer(RandomStream& random, std::vector<Message>& inbox, Time from, Time until) {
    constexpr Time kStep = 400 * cosim::kMicrosecond;
    constexpr std::uint8_t kAddress = 0x20;
    Time at = from + static_cast<Time>(random.below(static_cast<std::uint64_t>(until - from)));
    const auto phase = [&](cosim::I2cPhaseKind kind, unsigned byte) {
        cosim::I2cPhase next;
        next.kind = kind;
        next.byte = static_cast<std::uint8_t>(byte);
        next.start = at;
        next.clock_period = 10 * cosim::kMicrosecond;
        next.ack = 1;
        if (at < until) inbox.push_back({at, rab::RabNode::kI2c, next});
        at += kStep;
    };
    phase(cosim::I2cPhaseKind::Start, kAddress << 1);
    phase(cosim::I2cPhaseKind::Write, static_cast<unsigned>(random.below(20)));
    if (random.below(2) == 0) {
        phase(cosim::I2cPhaseKind::Write, static_cast<unsigned>(random.below(256)));
    } else {
        phase(cosim::I2cPhaseKind::Start, kAddress << 1 | 1);
        phase(cosim::I2cPhaseKind::Read, 0);
    }
    phase(cosim::I2cPhaseKind::Stop, 0);
    std::stable_sort(inbox.begin(), inbox.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
}

Stretch outside_of(RandomStream& random, const Plan& plan, Time from, Time until) {
    const double busy = random.below(3) == 0 ? 1e-3 : plan.busy;
    Stretch result = random_stretch(random, from, until, busy, plan.rab ? kRabSignals : kPicSignals);
    if (plan.rab && random.below(2) == 0) add_transfer(random, result.inbox, from, until);
    return result;
}

Time within(RandomStream& random, Time longest) {
    return 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(longest)));
}

void check(const MakeLogged& make, const Plan& plan, const std::string& name) {
    INFO(name);
    RandomStream random(11, name);
    const std::string twin_log = scratch_path("twin.log").string();
    const std::string board_log = scratch_path("board.log").string();
    const auto twin = make(twin_log);
    const auto board = make(board_log);
    cosim::Rewindable& back = *board->rewindable();
    Time now = 0;
    for (int i = 0; i < plan.marks; ++i) {
        INFO("mark " << i << " at " << cosim::to_seconds(now) << " s");
        back.mark();
        const std::string log = text_of(board_log);
        for (std::uint64_t times = random.below(3); times > 0; --times) {
            Time ahead = now;
            for (std::uint64_t steps = 1 + random.below(3); steps > 0; --steps) {
                const Time until = ahead + within(random, plan.ahead);
                run(*board, outside_of(random, plan, ahead, until));
                ahead = until;
            }
            CHECK(text_of(board_log) == log);
            back.rewind();
            const bool same_bytes = saved(*board) == saved(*twin);
            REQUIRE(same_bytes);
            REQUIRE(same_future(*board, *twin));
        }
        // The stretch that counts, with the mark or without it.
        if (random.below(2) == 0) back.settle();
        const Time until = now + within(random, plan.between);
        const Stretch outside = outside_of(random, plan, now, until);
        const bool same_messages = run(*board, outside) == run(*twin, outside);
        REQUIRE(same_messages);
        now = until;
        REQUIRE(same_future(*board, *twin));
        const bool same_bytes = saved(*board) == saved(*twin);
        REQUIRE(same_bytes);
    }
    if (random.below(2) == 0) {
        back.settle();
        CHECK(text_of(board_log) == text_of(twin_log));
    }
    CHECK(board->finish() == twin->finish());
    CHECK(contents(board_log) == contents(twin_log));
}

}  // namespace

TEST_CASE("own firmware goes back") {
    check(logged_pic(own_pic_image()),
          {.marks = 150, .between = 3 * cosim::kMillisecond, .ahead = 5 * cosim::kMillisecond}, "epuck.hex");
    check(logged_pic(own_pic_image(), false),
          {.marks = 40, .between = 9 * cosim::kMillisecond, .ahead = 20 * cosim::kMillisecond},
          "epuck.hex, nobody on the bus");
    check(logged_rab(own_rab_image()),
          {.marks = 200, .between = 2 * cosim::kMillisecond, .ahead = 2 * cosim::kMillisecond, .rab = true},
          "rab.hex");
}

TEST_CASE("random programs go back") {
    for (int seed = 0; seed < 60; ++seed) {
        RandomStream random(static_cast<std::uint64_t>(seed), "random programs");
        const bool family_33f = seed % 3 == 2;
        const image::Image image = random_program(random, family_33f);
        check(family_33f ? logged_rab(image) : logged_pic(image),
              {.marks = 12,
               .between = 3 * cosim::kMillisecond,
               .ahead = 3 * cosim::kMillisecond,
               .rab = family_33f},
              "random program " + std::to_string(seed));
    }
}

TEST_CASE("boards with faults go back") {
    for (int seed = 0; seed < 24; ++seed) {
        RandomStream random(static_cast<std::uint64_t>(seed), "faults that go back");
        const bool rab_board = seed % 3 == 2;
        std::vector<cosim::CarriedFault> faults;
        const auto add = [&](cosim::FaultSpec spec) {
            spec.name += std::to_string(faults.size());
            spec.begin = within(random, 30 * cosim::kMillisecond);
            if (random.below(2) == 0) spec.end = spec.begin + within(random, 60 * cosim::kMillisecond);
            spec.period = within(random, 5 * cosim::kMillisecond);
            spec.probability = 0.7;
            faults.push_back(carried(spec, faults.size()));
        };
        add(board_fault("flip"));
        add(board_fault("flip").set("space", "flash"));
        add(board_fault("reset").set("cause", "software"));
        add(board_fault("hang").set("duration", 1e-3 * random.uniform()));
        add(board_fault("hang").set("duration", 1e-5).set("pc", "0x108").set("nth", 2));
        add(board_fault("clock").set("ppm", 1e3 * random.uniform()).set("drift", 100));
        add(board_fault("adc_noise").set("channel", 8).set("sigma", 0.1));
        add(board_fault("interrupt").set("vector", "T1"));
        add(board_fault("lost_interrupt").set("vector", rab_board ? "T3" : "U2RX"));
        add(board_fault("late_interrupt").set("vector", "T1").set("delay", 1e-4).set("jitter", 1e-4));
        const image::Image image = seed < 12   ? random_program(random, rab_board)
                                   : rab_board ? own_rab_image()
                                               : own_pic_image();
        const MakeLogged make = [=](const std::string& log) -> std::unique_ptr<cosim::StatefulNode> {
            if (rab_board) {
                rab::RabNodeOptions options;
                options.log = log;
                options.faults = faults;
                return std::make_unique<rab::RabNode>(image, options);
            }
            pic::PicNodeOptions options;
            options.log = log;
            options.faults = faults;
            return std::make_unique<pic::PicNode>(image, options);
        };
        check(make,
              {.marks = 30,
               .between = 3 * cosim::kMillisecond,
               .ahead = 3 * cosim::kMillisecond,
               .rab = rab_board},
              "faults " + std::to_string(seed));
    }
}

TEST_CASE("a program that writes itself goes back") {
    for (const bool family_33f : {false, true}) {
        const image::Image image = self_programming(family_33f);
        check(family_33f ? logged_rab(image) : logged_pic(image),
              {.marks = 300,
               .between = cosim::kMillisecond,
               .ahead = 4 * cosim::kMillisecond,
               .busy = 30,
               .rab = family_33f},
              family_33f ? "itself, 33F" : "itself, 30F");
        // It does what it is there for.
        const auto board = (family_33f ? rab_board(image) : pic_board(image))();
        std::vector<Message> outbox;
        board->advance(400 * cosim::kMillisecond, {}, outbox);
        const std::string report = board->finish();
        CHECK(report.find("SWR") != std::string::npos);
        CHECK(report.find("IOPUWR") == std::string::npos);
    }
}

TEST_CASE("real images go back", "[images]") {
    int found = 0;
    for (const char* name : {"epuck_firmware.hex", "BTcom_default.hex", "Demo.hex",
                             "demoGCtronic-rev117+bootloader.hex", "bluetoot_mirror.hex"}) {
        const auto image = real_image(name);
        if (!image) continue;
        ++found;
        check(
            logged_pic(*image),
            {.marks = 60, .between = 30 * cosim::kMillisecond, .ahead = 20 * cosim::kMillisecond, .busy = 50},
            name);
    }
    for (const char* name : {"randb.hex", "erab_1to4b.hex"}) {
        const auto image = real_image(name);
        if (!image) continue;
        ++found;
        check(
            logged_rab(*image),
            {.marks = 100, .between = 6 * cosim::kMillisecond, .ahead = 2 * cosim::kMillisecond, .rab = true},
            name);
    }
    if (found == 0) WARN("PUCKLOOP_IMAGES has no images: skipped");
}
