// Noise at the microphones: as loud as stated, of its own streams, silent at 0.

#include "emu/pic/board.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop;

namespace {

struct Deaf : pic::BoardListener {
    void signal_changed(pic::SignalId, double, dspic::Cycle) override {}
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

int counts(pic::Board& board, int channel) {
    return static_cast<int>(std::floor(board.analog(channel, 10) * 4096));
}

pic::BoardParameters quiet() {
    pic::BoardParameters parameters;
    parameters.adc_noise_counts = 0;
    return parameters;
}

/// Mean of largest minus smallest over `windows` of `samples`.
double volume(pic::Board& board, int channel, int samples, int windows) {
    double sum = 0.0;
    for (int w = 0; w < windows; ++w) {
        int least = 4095, most = 0;
        for (int s = 0; s < samples; ++s) {
            const int value = counts(board, channel);
            least = std::min(least, value);
            most = std::max(most, value);
        }
        sum += most - least;
    }
    return sum / windows;
}

}  // namespace

TEST_CASE("a window of 100 samples spans the stated level, at its own microphone only") {
    Deaf deaf;
    pic::Board board(quiet(), deaf);
    board.set_signal(pic::kMicrophoneLevel + 1, 500, 0);
    // One window scatters by 12 % (0.605 of 5.015 deviations): the mean of 400 by 0.6 %.
    CHECK(volume(board, 3, 100, 400) == Approx(500).epsilon(0.02));
    // 25 samples span 3.931 deviations.
    CHECK(volume(board, 3, 25, 1000) == Approx(500 * 3.931 / 5.015).epsilon(0.02));
    CHECK(volume(board, 2, 100, 3) == 0);
    CHECK(counts(board, 2) == 2048);
    board.set_signal(pic::kMicrophoneLevel + 1, 0, 0);
    CHECK(volume(board, 3, 100, 3) == 0);
}

TEST_CASE("lost samples hold the one before, and a window spans less") {
    Deaf deaf;
    pic::Board board(quiet(), deaf);
    board.set_signal(pic::kMicrophoneLevel, 1000, 0);
    board.set_signal(pic::kMicrophoneLost, 0.75, 0);
    int held = 0, before = counts(board, 2);
    constexpr int kSamples = 4000;
    for (int s = 0; s < kSamples; ++s) {
        const int now = counts(board, 2);
        held += now == before;
        before = now;
    }
    // Equal counts by chance: 1 of 700. Three standard errors: 0.02.
    CHECK(static_cast<double>(held) / kSamples == Approx(0.75).margin(0.022));
    // As of 25 samples; their number varies, which costs 0.5 %.
    CHECK(volume(board, 2, 100, 1000) == Approx(1000 * 3.931 / 5.015).epsilon(0.025));
}

TEST_CASE("sound at the microphones shifts no other noise, and no sound draws nothing") {
    Deaf deaf;
    pic::BoardParameters parameters;
    parameters.adc_noise_counts = 2;
    pic::Board silent(parameters, deaf), loud(parameters, deaf);
    loud.set_signal(pic::kMicrophoneLevel, 300, 0);
    for (int i = 0; i < 100; ++i) {
        counts(silent, 2);
        counts(loud, 2);
        CHECK(counts(silent, 8) == counts(loud, 8));
    }
    // Whoever begins to hear later begins with the same sound.
    parameters.adc_noise_counts = 0;
    pic::Board first(parameters, deaf), second(parameters, deaf);
    first.set_signal(pic::kMicrophoneLevel, 300, 0);
    const int begins = counts(first, 2);
    for (int i = 0; i < 10; ++i)
        counts(second, 2);
    second.set_signal(pic::kMicrophoneLevel, 300, 0);
    CHECK(counts(second, 2) == begins);
}
