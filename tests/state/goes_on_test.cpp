// A board that loads a saved state goes on exactly as the saved one: own firmware, real images
// (PUCKLOOP_IMAGES) and random programs, saved at random times.

#include "tests/state/board_runs.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::Time;

namespace {

struct Plan {
    int states = 40;    ///< saved and loaded
    Time between = 0;   ///< longest time between two of them
    Time on = 0;        ///< how long both run on each time
    double busy = 300;  ///< messages a second
    std::size_t signals = kPicSignals;
    /// Later states are compared byte for byte. Skips of loops leave other dead words above the stack and
    /// note other arrivals at the loop than executing every cycle, and the copy has to learn its loops anew.
    bool same_bytes_later = true;
};

void check(const MakeBoard& make, const Plan& plan, const std::string& name) {
    INFO(name);
    RandomStream random(7, name);
    const auto original = make();
    Time now = 0;
    for (int i = 0; i < plan.states; ++i) {
        const Time at = now + 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(plan.between)));
        run(*original, random_stretch(random, now, at, plan.busy, plan.signals));
        now = at;
        INFO("state " << i << " at " << cosim::to_seconds(at) << " s");
        const auto bytes = saved(*original);
        const auto copy = loaded(make, bytes);
        const bool same_bytes = saved(*copy) == bytes;
        REQUIRE(same_bytes);
        REQUIRE(same_future(*copy, *original));
        const Stretch outside = random_stretch(random, now, now + plan.on, plan.busy, plan.signals);
        now += plan.on;
        const auto sent = run(*original, outside);
        const bool same_messages = sent == run(*copy, outside);
        REQUIRE(same_messages);
        REQUIRE(same_future(*copy, *original));
        const bool same_state = !plan.same_bytes_later || saved(*copy) == saved(*original);
        CHECK(same_state);
        CHECK(copy->finish() == original->finish());
    }
}

}  // namespace

TEST_CASE("own firmware goes on from a saved state") {
    Plan main{.states = 100,
              .between = 40 * cosim::kMillisecond,
              .on = 60 * cosim::kMillisecond,
              .same_bytes_later = false};
    check(pic_board(own_pic_image()), main, "epuck.hex");
    main.states = 20;
    main.same_bytes_later = true;
    check(pic_board(own_pic_image(), false), main, "epuck.hex, every cycle executed");
    Plan plan{.states = 60,
              .between = 10 * cosim::kMillisecond,
              .on = 20 * cosim::kMillisecond,
              .signals = kRabSignals,
              .same_bytes_later = false};
    check(rab_board(own_rab_image()), plan, "rab.hex");
    plan.states = 20;
    plan.same_bytes_later = true;
    check(rab_board(own_rab_image(), false), plan, "rab.hex, every cycle executed");
}

TEST_CASE("random programs go on from a saved state") {
    for (int seed = 0; seed < 30; ++seed) {
        RandomStream random(static_cast<std::uint64_t>(seed), "random programs");
        const bool family_33f = seed % 3 == 2;
        const image::Image image = random_program(random, family_33f);
        check(family_33f ? rab_board(image) : pic_board(image),
              {.states = 10,
               .between = 3 * cosim::kMillisecond,
               .on = 2 * cosim::kMillisecond,
               .signals = family_33f ? kRabSignals : kPicSignals},
              "random program " + std::to_string(seed));
    }
}

TEST_CASE("real images go on from a saved state", "[images]") {
    int found = 0;
    for (const char* name : {"epuck_firmware.hex", "BTcom_default.hex", "Demo.hex",
                             "demoGCtronic-rev117+bootloader.hex", "bluetoot_mirror.hex"}) {
        const auto image = real_image(name);
        if (!image) continue;
        ++found;
        check(pic_board(*image),
              {.states = 40, .between = cosim::kSecond, .on = 100 * cosim::kMillisecond, .busy = 20}, name);
    }
    for (const char* name : {"randb.hex", "erab_1to4b.hex"}) {
        const auto image = real_image(name);
        if (!image) continue;
        ++found;
        Plan plan{.states = 30,
                  .between = 30 * cosim::kMillisecond,
                  .on = 20 * cosim::kMillisecond,
                  .signals = kRabSignals,
                  .same_bytes_later = false};
        check(rab_board(*image), plan, name);
        plan.states = 10;
        plan.same_bytes_later = true;
        check(rab_board(*image, false), plan, name + std::string(", every cycle executed"));
    }
    if (found == 0) WARN("PUCKLOOP_IMAGES has no images: skipped");
}
