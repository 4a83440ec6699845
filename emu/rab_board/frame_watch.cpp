#include "emu/rab_board/frame_watch.h"

#include "emu/rab_board/signals.h"
#include "protocols/infrared/rab_frame.h"

#include <algorithm>

namespace puckloop::rab {

namespace {

using cosim::Time;

constexpr Time kChip = 98'085 * cosim::kNanosecond;
/// Within a frame at most two chips in a row are off, between queued frames one more: three end a burst.
constexpr Time kSilence = 7 * kChip / 2;

}  // namespace

void FrameWatch::change(std::uint16_t emitters, Time now) {
    settle(now);
    if (!chips_.empty() || emitters_ != 0) append(now);
    if (chips_.empty()) began_ = now;
    emitters_ = emitters;
    since_ = now;
}

/// The chips from the last change on.
void FrameWatch::append(Time until) {
    const auto count = static_cast<std::size_t>((until - since_ + kChip / 2) / kChip);
    const std::size_t room = kLongestBurst - chips_.size();
    overlong_ |= count > room;
    chips_.insert(chips_.end(), std::min(count, room), emitters_);
}

void FrameWatch::settle(Time now) {
    if (chips_.empty() || emitters_ != 0 || now - since_ < kSilence) return;
    close(since_ + kSilence);
}

/// Is this the end of the burst, or one chip off and then a preamble?
bool FrameWatch::ends_at(std::size_t end) const {
    if (end >= chips_.size()) return true;
    const auto first = chips_.begin() + static_cast<std::ptrdiff_t>(end);
    const auto left = static_cast<std::size_t>(chips_.end() - first);
    constexpr auto kPreamble = static_cast<std::size_t>(protocols::kRabPreambleChips);
    return *first == 0 && left > kPreamble &&
           std::all_of(first + 1, first + 1 + kPreamble, [](std::uint16_t chip) { return chip != 0; });
}

/// Length of the frame that begins at chip `first`, 0 if none does; fills in size and payloads.
std::size_t FrameWatch::frame_at(std::size_t first, EmittedFrame& frame) const {
    const std::uint16_t active = chips_[first];
    for (const int size : protocols::kRabSizes) {
        const auto length = static_cast<std::size_t>(protocols::rab_frame_chips(size));
        // Of two lengths that read well the one that ends with the burst or before the next preamble is it.
        if (!ends_at(first + length)) continue;
        frame.size = size;
        frame.payloads.clear();
        bool good = true;
        for (int i = 0; i < kSensorCount && good; ++i) {
            if (((active >> i) & 1u) == 0) continue;
            std::string text(length, '0');
            for (std::size_t k = 0; k < length && first + k < chips_.size(); ++k)
                if (((chips_[first + k] >> i) & 1u) != 0) text[k] = '1';
            const protocols::RabFrameReading reading = protocols::decode_rab(text, size);
            good = reading.ok();
            frame.payloads[reading.payload] |= static_cast<std::uint16_t>(1u << i);
        }
        if (good) return length;
    }
    return 0;
}

void FrameWatch::close(Time seen) {
    const std::vector<std::uint16_t>& chips = chips_;
    bool regular = !overlong_;
    for (std::size_t at = 0; at < chips.size() && regular;) {
        EmittedFrame frame;
        frame.start = began_ + static_cast<Time>(at) * kChip;
        frame.seen = seen;
        const std::size_t length = chips[at] != 0 ? frame_at(at, frame) : 0;
        regular = length != 0;
        if (!regular) break;
        ++frames_;
        if (on_frame) on_frame(frame);
        at += length + 1;  // one chip off between queued frames
    }
    if (!regular) {
        ++irregular_;
        if (on_irregular) on_irregular(began_, seen, chips.size());
    }
    chips_.clear();
    overlong_ = false;
}

}  // namespace puckloop::rab
