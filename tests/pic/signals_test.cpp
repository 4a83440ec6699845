#include "emu/pic/signals.h"

#include <catch2/catch.hpp>

#include <set>
#include <string>

using namespace puckloop;
using cosim::SignalDirection;

TEST_CASE("the board's signal list is in the order of its ids") {
    const auto list = pic::signals();
    REQUIRE(list.size() == pic::kSignalCount);
    CHECK(list[pic::kProximity + 7].name == "proximity7");
    CHECK(list[pic::kAmbient].name == "ambient0");
    CHECK(list[pic::kMicrophone + 2].name == "mic2");
    CHECK(list[pic::kAcceleration + 2].name == "acc_z");
    CHECK(list[pic::kAdc + 15].name == "adc15");
    CHECK(list[pic::kBatteryVoltage].name == "battery_v");
    CHECK(list[pic::kBatteryLow].name == "battery_low");
    CHECK(list[pic::kSelector].name == "selector");
    CHECK(list[pic::kRemote].name == "remote");
    CHECK(list[pic::kWheelLeft].name == "wheel_left");
    CHECK(list[pic::kLed + 7].name == "led7");
    CHECK(list[pic::kLedFront].name == "led_front");
    CHECK(list[pic::kLedBody].name == "led_body");
    CHECK(list[pic::kPulse + 3].name == "pulse3");
    CHECK(list[pic::kAudioOn].name == "audio_on");
    CHECK(list[pic::kCameraReset].name == "camera_reset");
    CHECK(list[pic::kMicrophoneLevel + 2].name == "mic_level2");
    CHECK(list[pic::kMicrophoneLost].name == "mic_lost");
    CHECK(list[pic::kResetButton].name == "reset");
}

TEST_CASE("signal names are unique, found by name, and inputs come before outputs but for later ones") {
    std::set<std::string> names;
    for (const auto& info : pic::signals()) {
        CHECK(names.insert(info.name).second);
        CHECK(info.min < info.max);
        CHECK(info.initial >= info.min);
        CHECK(info.initial <= info.max);
        CHECK_FALSE(info.description.empty());
    }
    for (std::uint16_t id = 0; id < pic::kSignalCount; ++id) {
        CHECK(cosim::find_signal(pic::signals(), pic::signals()[id].name) == id);
        const bool input = pic::signals()[id].direction == SignalDirection::Input;
        CHECK(input == ((id < pic::kWheelLeft || id >= pic::kMicrophoneLevel) && id != pic::kSpeaker));
    }
    CHECK_FALSE(cosim::find_signal(pic::signals(), "proximity8"));
}
