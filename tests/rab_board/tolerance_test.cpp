// What a receiver stands and what it loses: range-and-bearing fact sheet 4.5 and 4.6, with an ideal channel
// (demodulators need 8 us to come on and to go off). Shares are of a few dozen phases, so margins are wide.

#include "protocols/infrared/rab_frame.h"
#include "tests/rab_board/rab_rig.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

using namespace puckloop;
using protocols::encode_rab;
using rab::kChip;
using rab::RabRig;

namespace {

constexpr double kLead = 0.001;
constexpr double kFrameSeconds = 0.016;  // until everything is over, whatever went wrong

struct Channel {
    double on_s = 8e-6, off_s = 8e-6;
    double chip_s = kChip;
    int size = 16;
};

/// Share of frames lost over `phases` start phases spread over a chip; `disturb` may act during a frame.
template <typename Disturb>
double lost(const std::string& file, double i2c_hertz, int phases, const Channel& channel, Disturb disturb) {
    RabRig rig(file, i2c_hertz);
    rig.boot();
    if (channel.size != 16) rig.write(21, {static_cast<std::uint8_t>(channel.size)});
    int missing = 0;
    for (int phase = 0; phase < phases; ++phase) {
        const double start = rig.now_s() + kLead + phase * kChip / phases;
        const std::uint32_t payload = 0x1000u + static_cast<std::uint32_t>(phase);
        rig.show(start, encode_rab(channel.size, payload), {{0, 1000}}, channel.chip_s, channel.on_s,
                 channel.off_s);
        disturb(rig, start, phase);
        rig.run_to(start + kFrameSeconds);
        const auto message = rig.poll();
        const bool arrived = message && (message->data & 0xFFFF) == payload;
        missing += arrived ? 0 : 1;
        // After a loss the decoder may be left in the middle of a frame: a second one puts it right.
        if (!arrived) {
            for (int i = 0; i < 2; ++i) {
                rig.show(rig.now_s() + kLead, encode_rab(channel.size, 0), {{0, 1000}}, kChip);
                rig.run_for(kLead + kFrameSeconds);
            }
            while (rig.poll()) {
            }
        }
    }
    return static_cast<double>(missing) / phases;
}

void nothing(RabRig&, double, int) {}

}  // namespace

TEST_CASE("4.6: at any phase of the receiver a clean frame comes through, but for the edge of a sample") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const double share = lost(*file, 100e3, 49, {}, nothing);
    CHECK(share <= 1.0 / 49);
}

TEST_CASE("4.6: a demodulator that is 15 us slower one way loses about a sixth of the phases") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const double share = lost(*file, 100e3, 49, {.on_s = 8e-6, .off_s = 23e-6}, nothing);
    CHECK(share == Approx(0.16).margin(0.05));
}

TEST_CASE("4.6: clocks that differ") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    struct Row {
        int size;
        double mismatch, lost;
    };
    const Row row =
        GENERATE(Row{16, 0.001, 0.0}, Row{16, 0.002, 0.12}, Row{16, 0.004, 0.19}, Row{16, 0.008, 0.37},
                 Row{32, 0.001, 0.12}, Row{32, 0.004, 0.31}, Row{32, 0.008, 0.69});
    const double share =
        lost(*file, 100e3, 32, {.chip_s = kChip * (1 + row.mismatch), .size = row.size}, nothing);
    INFO(row.size << " bits, " << row.mismatch * 100 << " %");
    CHECK(share == Approx(row.lost).margin(0.08));
}

TEST_CASE("4.6: one register read on the receiver during a frame") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const auto [hertz, sheet, margin] =
        GENERATE(table<double, double, double>({{100e3, 0.43, 0.12}, {400e3, 0.03, 0.05}}));
    const double share = lost(*file, hertz, 48, {}, [](RabRig& rig, double start, int phase) {
        rig.play(fmt::format("{:.9f} r 0x20 9 1\n", start + 0.0005 + phase * 53e-6));
    });
    INFO(hertz << " Hz");
    CHECK(share == Approx(sheet).margin(margin));
}

TEST_CASE(
    "4.5: a frame that starts 25 chips after another one's end is received, one 24 chips after is not") {
    const auto file = exec::real_image(rab::kRandb);
    if (!file) return;
    const auto received = [&](int gap) {
        int second = 0;
        for (int phase = 0; phase < 4; ++phase) {
            RabRig rig(*file);
            rig.boot();
            const double start = rig.now_s() + kLead + phase * kChip / 4;
            rig.show(start, encode_rab(16, 0xFFFF), {{0, 1000}});
            rig.show(start + (46 + gap) * kChip, encode_rab(16, 0x5555), {{0, 1000}});
            rig.run_for(0.03);
            while (const auto message = rig.poll())
                second += message->data == 0x5555 ? 1 : 0;
        }
        return second;
    };
    CHECK(received(24) == 0);
    CHECK(received(25) == 4);
}
