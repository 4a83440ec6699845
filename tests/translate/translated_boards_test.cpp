// Whole boards with and without translation: own firmware, real images (PUCKLOOP_IMAGES) and programs of
// random words, under random inputs and cuts, must agree in everything they remember and send.

#include "tests/state/board_runs.h"
#include "tests/translate/translation_guard.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::tests;
using cosim::Time;

namespace {

std::unique_ptr<cosim::StatefulNode> made(const MakeBoard& make, bool translated, std::uint8_t hot) {
    const TranslationGuard guard(translated, hot);
    return make();
}

struct Plan {
    int stretches = 20;
    Time longest = 0;   ///< between two comparisons
    double busy = 300;  ///< messages a second
    std::size_t signals = kPicSignals;
    std::uint8_t hot = 1;
};

void check(const MakeBoard& make, const Plan& plan, const std::string& name) {
    INFO(name);
    RandomStream random(11, name);
    const auto fast = made(make, true, plan.hot), slow = made(make, false, plan.hot);
    Time now = 0;
    for (int i = 0; i < plan.stretches; ++i) {
        const Time at = now + 1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(plan.longest)));
        const Stretch outside = random_stretch(random, now, at, plan.busy, plan.signals);
        now = at;
        INFO("stretch " << i << " to " << cosim::to_seconds(at) << " s");
        const bool same_messages = run(*fast, outside) == run(*slow, outside);
        REQUIRE(same_messages);
        REQUIRE(same_future(*fast, *slow));
        const bool same_state = saved(*fast) == saved(*slow);
        REQUIRE(same_state);
    }
    CHECK(fast->finish() == slow->finish());
}

}  // namespace

TEST_CASE("own firmware, translated and interpreted") {
    for (const std::uint8_t hot : {std::uint8_t{1}, chip::kHot}) {
        check(pic_board(own_pic_image()), {.stretches = 40, .longest = 60 * cosim::kMillisecond, .hot = hot},
              "epuck.hex");
        const Plan plan{
            .stretches = 40, .longest = 20 * cosim::kMillisecond, .signals = kRabSignals, .hot = hot};
        check(rab_board(own_rab_image()), plan, "rab.hex");
        check(rab_board(own_rab_image(), false), plan, "rab.hex, every cycle executed");
    }
}

TEST_CASE("real images, translated and interpreted") {
    bool any = false;
    for (const char* name : {"epuck_firmware.hex", "epuck_firmware_old.hex", "demoGCtronic.X.production.hex",
                             "BTcom_default.hex", "Demo.hex"})
        if (const auto image = real_image(name)) {
            any = true;
            check(pic_board(*image), {.stretches = 15, .longest = 100 * cosim::kMillisecond}, name);
        }
    for (const char* name : {"randb.hex", "erab_1to4b.hex"})
        if (const auto image = real_image(name)) {
            any = true;
            check(rab_board(*image),
                  {.stretches = 15, .longest = 40 * cosim::kMillisecond, .signals = kRabSignals}, name);
        }
    if (!any) WARN("skipped: PUCKLOOP_IMAGES names no folder of real images");
}

TEST_CASE("programs of random words, translated and interpreted") {
    for (int seed = 0; seed < 40; ++seed) {
        RandomStream random(static_cast<std::uint64_t>(seed), "random words");
        const bool family_33f = seed % 3 == 2;
        const image::Image image = random_program(random, family_33f);
        check(family_33f ? rab_board(image) : pic_board(image),
              {.stretches = 10,
               .longest = 4 * cosim::kMillisecond,
               .signals = family_33f ? kRabSignals : kPicSignals},
              "random words " + std::to_string(seed));
    }
}
