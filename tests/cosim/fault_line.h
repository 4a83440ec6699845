#pragma once
// A UART line with one fault on it, outside any run: bytes go in, what arrives comes out.

#include "base/random.h"
#include "cosim/faults/faults.h"

#include <algorithm>
#include <string>
#include <vector>

namespace puckloop::cosim::toy {

inline constexpr Time kBit = 8'680'556;  // 115200 baud
inline constexpr Time kByte = 10 * kBit;

class FaultLine {
  public:
    explicit FaultLine(const FaultSpec& spec, std::uint64_t seed = 1)
        : fault_(make_fault(spec, {Direction::FromA, 9 * kBit, 0, PlaceKind::Uart, "sender"}, seed, 0)) {
        for (const Delivery& delivery : fault_->preset())
            all.push_back(delivery);
    }

    UartFrame send(Time start, unsigned data, UartFrame frame = {}) {
        frame.start = start;
        frame.bit_period = kBit;
        frame.data = static_cast<std::uint16_t>(data);
        const Time stop = start + kBit * (1 + frame.data_bits + (frame.parity != 0 ? 1 : 0));
        std::vector<Delivery> batch{{Message{stop, 0, frame}, FaultKind::None}};
        fault_->apply(batch, {stop, sent++});
        for (const Delivery& one : batch) {
            if (one.message.time < stop) early = true;
            all.push_back(one);
        }
        return frame;
    }
    /// Records of `length` random bytes, back to back, with a pause after each.
    std::vector<unsigned> send_records(int records, int length, RandomStream& random, UartFrame like = {}) {
        std::vector<unsigned> bytes;
        for (int r = 0; r < records; ++r, now += 30 * kByte)
            for (int i = 0; i < length; ++i, now += kByte + (like.parity ? kBit : 0)) {
                bytes.push_back(static_cast<unsigned>(random.below(256)));
                send(now, bytes.back(), like);
            }
        return bytes;
    }

    std::vector<UartFrame> arrived() const {
        std::vector<UartFrame> frames;
        for (const Delivery& one : all)
            if (!keeps_from_arriving(one.fault)) frames.push_back(std::get<UartFrame>(one.message.payload));
        std::stable_sort(frames.begin(), frames.end(),
                         [](const UartFrame& a, const UartFrame& b) { return a.start < b.start; });
        return frames;
    }
    std::vector<unsigned> bytes() const {
        std::vector<unsigned> values;
        for (const UartFrame& frame : arrived())
            values.push_back(frame.data);
        return values;
    }
    /// No two frames on the line at a time.
    bool in_turn() const {
        const std::vector<UartFrame> frames = arrived();
        for (std::size_t i = 1; i < frames.size(); ++i) {
            const UartFrame& before = frames[i - 1];
            const Time bits = 1 + before.data_bits + (before.parity ? 1 : 0) + before.stop_bits;
            if (frames[i].start < before.start + bits * before.bit_period - kBit / 8) return false;
        }
        return true;
    }
    const Evidence& evidence() const { return fault_->evidence(); }

    std::vector<Delivery> all;
    std::uint64_t sent = 0;
    Time now = kMillisecond;
    bool early = false;

  private:
    std::unique_ptr<LinkFault> fault_;
};

}  // namespace puckloop::cosim::toy
