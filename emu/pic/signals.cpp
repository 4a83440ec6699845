// Ranges: 12-bit ADC counts over the 3.3 V analog supply (facts: e-puck board, quantities and raw values).

#include "emu/pic/signals.h"

#include <fmt/format.h>

#include <vector>

namespace puckloop::pic {

namespace {

using cosim::SignalDirection;
using cosim::SignalInfo;

constexpr double kFullScale = 4095;
constexpr double kRoomLight = 3800;  // ordinary room 3450..3860; dark ~4000
constexpr double kMidScale = 2048;
constexpr double kOneG = 800;       // counts for 1 g
constexpr double kBrightest = 1e6;  // far beyond what the converter shows
constexpr double kStepRange = 2147483647;

struct ListBuilder {
    std::vector<SignalInfo> list;

    void input(std::string name, const char* unit, double min, double max, double initial, std::string text) {
        list.push_back({std::move(name), SignalDirection::Input, unit, min, max, std::move(text), initial});
    }
    void counts(std::string name, double initial, std::string text) {
        input(std::move(name), "counts", 0, kFullScale, initial, std::move(text));
    }
    void output(std::string name, const char* unit, double min, double max, std::string text) {
        list.push_back({std::move(name), SignalDirection::Output, unit, min, max, std::move(text), 0.0});
    }
    void level(std::string name, std::string text) {
        output(std::move(name), "level", 0, 1, std::move(text));
    }
};

std::vector<SignalInfo> build() {
    ListBuilder b;
    for (int i = 0; i < kProximityCount; ++i)
        b.counts(fmt::format("proximity{}", i), 0,
                 fmt::format("reflected light: drop of AN{} while pulse {} is on", 8 + i, i % kPulseCount));
    for (int i = 0; i < kProximityCount; ++i)
        b.counts(fmt::format("ambient{}", i), kRoomLight,
                 fmt::format("AN{} with its pulse off; dark 4000, brighter is smaller", 8 + i));
    const char* const microphones[] = {"right", "left", "back"};
    for (int i = 0; i < kMicrophoneCount; ++i)
        b.counts(fmt::format("mic{}", i), kMidScale,
                 fmt::format("microphone {}, AN{}", microphones[i], 2 + i));
    b.counts("acc_x", kMidScale, "accelerometer x (right), AN5; 1 g is 800 counts");
    b.counts("acc_y", kMidScale, "accelerometer y (rear), AN6");
    b.counts("acc_z", kMidScale + kOneG, "accelerometer z (up), AN7; 1 g at rest");
    for (int i = 0; i < kAdcCount; ++i)
        if (i < 2)
            b.counts(fmt::format("adc{}", i), kRoomLight, fmt::format("level at AN{}", i));
        else if (i < 8)
            b.counts(fmt::format("adc{}", i), i == 7 ? kMidScale + kOneG : kMidScale,
                     fmt::format("level at AN{0}; same input as {1}{2}", i, i < 5 ? "mic" : "acc_",
                                 i < 5 ? std::string(1, static_cast<char>('0' + i - 2))
                                       : std::string(1, static_cast<char>('x' + i - 5))));
        else
            b.counts(fmt::format("adc{}", i), kRoomLight,
                     fmt::format("level at AN{} with its pulse off; same input as ambient{}", i, i - 8));
    b.input("battery_v", "V", 0, 5, 3.9, "battery voltage; RF1 falls below 3.4 V");
    b.input("battery_low", "level", 0, 1, 0,
            "1 = battery low (RF1 at 0); the last of battery_v, battery_low wins");
    b.input("selector", "position", 0, 15, 0, "16-position switch on RG6..RG9");
    b.input("remote", "level", 0, 1, 1, "infra-red remote receiver on RF6; idle 1");

    b.output("wheel_left", "steps", -kStepRange, kStepRange, "left motor steps since power-up, + is forward");
    b.output("wheel_right", "steps", -kStepRange, kStepRange,
             "right motor steps since power-up, + is forward");
    for (int i = 0; i < kLedCount; ++i)
        b.level(fmt::format("led{}", i), "ring LED, 0 = front, then clockwise");
    b.level("led_front", "front LED");
    b.level("led_body", "green body LED");
    for (int i = 0; i < kPulseCount; ++i)
        b.level(fmt::format("pulse{}", i), fmt::format("infra-red emitters of sensors {} and {}", i, i + 4));
    b.level("audio_on", "codec and amplifier out of reset");
    b.level("camera_reset", "camera reset line, active low");

    for (int i = 0; i < kMicrophoneCount; ++i)
        b.counts(fmt::format("mic_level{}", i), 0,
                 fmt::format("sound about mic{}: largest minus smallest of 100 samples", i));
    b.input("mic_lost", "1", 0, 1, 0, "share of microphone samples that hold the one before");
    b.input("reset", "level", 0, 1, 0, "reset button; a change to 1 resets the chip (MCLR)");
    for (int i = 0; i < kProximityCount; ++i)
        b.input(fmt::format("ir_light{}", i), "counts", 0, kBrightest, 0,
                fmt::format("infra-red light of other robots and booths at AN{}, by which it drops", 8 + i));
    b.output("speaker", "1", -1, 1, "what the codec drives the speaker with, 1 is full scale");
    for (int i = 0; i < kMicrophoneCount; ++i)
        b.input(fmt::format("sound{}", i), "counts", -kFullScale, kFullScale, 0,
                fmt::format("sound wave about mic{}; joined by straight lines of 62.5 us", i));
    b.input("line_in", "1", -1, 1, 0, "codec's line input, 1 is full scale; leads nowhere on the robot");
    return b.list;
}

}  // namespace

std::span<const SignalInfo> signals() {
    static const std::vector<SignalInfo> list = build();
    return list;
}

}  // namespace puckloop::pic
