#include "emu/rab_board/signals.h"

#include <catch2/catch.hpp>

#include <set>
#include <string>

using namespace puckloop;
using cosim::SignalDirection;

TEST_CASE("the range-and-bearing board's signal list is in the order of its ids") {
    const auto list = rab::signals();
    REQUIRE(list.size() == rab::kSignalCount);
    CHECK(list[rab::kDemodulator].name == "demod1");
    CHECK(list[rab::kDemodulator + 11].name == "demod12");
    CHECK(list[rab::kPeak].name == "peak1");
    CHECK(list[rab::kEmitter + 11].name == "emitter12");
    CHECK(list[rab::kCarrier].name == "carrier");
    CHECK(list[rab::kPower].name == "power");
    CHECK(list[rab::kLed].name == "led");
    CHECK(list[rab::kPeakReset + 11].name == "peak_reset12");
    CHECK(list[rab::kBattery].name == "battery_v");
    CHECK(list[rab::kVdd].name == "vdd");
    std::set<std::string> names;
    for (std::size_t id = 0; id < list.size(); ++id) {
        CHECK(names.insert(list[id].name).second);
        CHECK((list[id].direction == SignalDirection::Input) == (id < rab::kEmitter || id >= rab::kBattery));
    }
}
