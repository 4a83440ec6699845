#pragma once
// Random things that happen to a TAM's board: switches, light, battery, characters on both lines, the reset
// button. The same stretch applied to two boards gives the same result, or something is wrong.

#include "base/random.h"
#include "base/states/archive.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "tests/tam_board/rig.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace puckloop::tam::test {

struct Stimulus {
    cosim::Time at = 0;
    enum class Kind { Signal, Character, Reset } kind = Kind::Signal;
    SignalId signal = 0;
    double value = 0;
    int unit = 0;
    cosim::UartFrame frame{};
};
struct Stretch {
    std::vector<Stimulus> stimuli;
    cosim::Time until = 0;
};

/// About `per_second` stimuli, and now and then what a radio module would send. Some are late for their
/// bytes.
inline Stretch random_stretch(RandomStream& random, cosim::Time from, cosim::Time until, double per_second) {
    using cosim::Time;
    Stretch stretch{{}, until};
    const auto within = [&] {
        return from + static_cast<Time>(random.below(static_cast<std::uint64_t>(until - from)));
    };
    const auto character = [&](int unit, Time stop, unsigned byte, Time bit) {
        Stimulus s;
        s.kind = Stimulus::Kind::Character;
        s.at = stop;
        s.unit = unit;
        s.frame.bit_period = bit;
        s.frame.start = stop - 9 * bit;
        s.frame.data = static_cast<std::uint16_t>(byte);
        if (stop < until) stretch.stimuli.push_back(s);
    };
    constexpr Time kRadioBit = cosim::kSecond / 9600, kConsoleBit = cosim::kSecond / 57600;
    const double expected = per_second * cosim::to_seconds(until - from);
    for (double left = expected * 2 * random.uniform(); left > random.uniform(); --left) {
        Stimulus s;
        s.at = within();
        const auto what = random.below(12);
        if (what == 0 && random.below(40) == 0) {
            s.kind = Stimulus::Kind::Reset;
        } else if (what < 3) {
            character(static_cast<int>(what & 1), s.at, static_cast<unsigned>(random.below(256)),
                      what & 1 ? kRadioBit : kConsoleBit);
            continue;
        } else if (what < 5) {  // an answer of the radio module
            const protocols::XBeeMessage messages[] = {
                protocols::XBeeModemStatus{}, protocols::XBeeTxStatus{.id = 1},
                protocols::XBeeRx{.from = 0x0013A200408A3107, .options = 1, .data = {0x0A, 25, 3, 7}},
                protocols::XBeeRx{.from = 0x0013A200408A3107, .options = 1, .data = {0x0C, 0xA5}},
                protocols::XBeeAtResponse{.command = {'D', 'N'},
                                          .status = 0x40,
                                          .value = {0xFF, 0xFE, 0, 0x13, 0xA2, 0, 0x40, 0x8A, 0x31, 7}}};
            Time stop = s.at;
            for (const std::uint8_t byte :
                 encode_xbee(encode(messages[random.below(5)]), protocols::XBeeApiMode::Escaped))
                character(1, stop += 10 * kRadioBit, byte, kRadioBit);
            continue;
        } else {
            s.signal = static_cast<SignalId>(random.below(kProximityEmit));
            s.value = s.signal == kBattery ? 2.8 + random.uniform() : static_cast<double>(random.below(2));
        }
        stretch.stimuli.push_back(s);
    }
    std::stable_sort(stretch.stimuli.begin(), stretch.stimuli.end(),
                     [](const Stimulus& a, const Stimulus& b) { return a.at < b.at; });
    return stretch;
}

inline void apply(Board& board, const Stretch& stretch) {
    for (const Stimulus& s : stretch.stimuli) {
        board.run_until(std::max(board.now(), s.at));
        if (s.kind == Stimulus::Kind::Signal) board.set_signal(s.signal, s.value);
        if (s.kind == Stimulus::Kind::Character) board.uart_receive(s.unit, s.frame);
        if (s.kind == Stimulus::Kind::Reset) board.reset_button();
    }
    board.run_until(stretch.until);
}

inline std::vector<std::uint8_t> saved(Board& board) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    board.state(writer);
    return bytes;
}

/// What left the boards is the same.
inline bool same_output(const Rig& a, const Rig& b) {
    const auto changes = std::equal(a.changes.begin(), a.changes.end(), b.changes.begin(), b.changes.end(),
                                    [](const Rig::Change& x, const Rig::Change& y) {
                                        return x.id == y.id && x.value == y.value && x.at == y.at;
                                    });
    const auto frames = std::equal(
        a.frames.begin(), a.frames.end(), b.frames.begin(), b.frames.end(), [](const auto& x, const auto& y) {
            return x.first == y.first && x.second.start == y.second.start && x.second.data == y.second.data;
        });
    const auto phases = std::equal(a.phases.begin(), a.phases.end(), b.phases.begin(), b.phases.end(),
                                   [](const cosim::I2cPhase& x, const cosim::I2cPhase& y) {
                                       return x.kind == y.kind && x.start == y.start && x.byte == y.byte;
                                   });
    return changes && frames && phases;
}

}  // namespace puckloop::tam::test
