// A sound is one spell, however often its wave passes 0.

#include "view/events/sound_spells.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <utility>
#include <vector>

using puckloop::view::SoundSpells;

TEST_CASE("two tones with a pause between them are two spells") {
    std::vector<std::pair<double, bool>> heard;
    const auto note = [&](double time, bool plays) { heard.emplace_back(time, plays); };
    SoundSpells spells;
    constexpr double kRate = 7200;
    spells.sample(0.0, true, note);  // silence is nothing
    for (int i = 0; i < 720; ++i)
        spells.sample(1.0 + i / kRate, i % 8 == 0 && i > 0, note);
    spells.sample(1.1, true, note);
    for (int i = 0; i < 720; ++i)
        spells.sample(2.0 + i / kRate, i % 8 == 0 && i > 0, note);
    spells.sample(2.1, true, note);
    REQUIRE(heard.size() == 3);
    spells.settle(2.11, note);  // it may go on
    CHECK(heard.size() == 3);
    spells.settle(3.0, note);
    const std::vector<std::pair<double, bool>> expected{{1.0, true}, {1.1, false}, {2.0, true}, {2.1, false}};
    CHECK(heard == expected);
}
