#include "cosim/faults/frame_match.h"

#include <algorithm>

namespace puckloop::cosim {

int bits_of(const UartFrame& frame) {
    return 1 + frame.data_bits + (frame.parity != 0 ? 1 : 0) + frame.stop_bits;
}

Time frame_time(const UartFrame& frame) {
    return frame.bit_period * bits_of(frame);
}

Time frame_time(const RadioFrame& frame) {
    return frame.duration;
}

std::uint32_t RecordCount::place(const UartFrame& frame) {
    if (frame.start > next_ + frame_time(frame)) {
        last_length_ = sent_;
        sent_ = 0;
    }
    next_ = frame.start + frame_time(frame);
    return sent_++;
}

FrameMatch::FrameMatch(const FaultSpec& spec) : spec_(spec) {}

bool FrameMatch::after_pattern(std::uint8_t byte) {
    newest_.push_back(byte);
    if (newest_.size() > spec_.match.size()) newest_.erase(newest_.begin());
    for (std::uint32_t& left : due_)
        --left;
    if (newest_ == spec_.match) due_.push_back(spec_.offset);
    if (due_.empty() || due_.front() != 0) return false;
    due_.erase(due_.begin());
    return true;
}

bool FrameMatch::operator()(const UartFrame& frame) {
    const bool placed = !spec_.position || records_.place(frame) == *spec_.position;
    const bool follows = spec_.match.empty() || after_pattern(static_cast<std::uint8_t>(frame.data));
    const bool among = spec_.bytes.empty() ||
                       std::find(spec_.bytes.begin(), spec_.bytes.end(), frame.data) != spec_.bytes.end();
    return placed && follows && among;
}

bool FrameMatch::operator()(const RadioFrame& frame) const {
    if (!spec_.bytes.empty() || spec_.position) return false;
    if (spec_.match.empty()) return true;
    const auto octets = frame.octets.view();
    return std::search(octets.begin(), octets.end(), spec_.match.begin(), spec_.match.end()) != octets.end();
}

}  // namespace puckloop::cosim
