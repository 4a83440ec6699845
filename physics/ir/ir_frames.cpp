#include "physics/ir/ir_frames.h"

#include "base/json.h"
#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace puckloop::physics {

using cosim::Time;

namespace {

constexpr Time kDarkEndChips = 3;   // dark for longer: the frame is over
constexpr Time kPreambleChips = 4;  // light for as long: a preamble
constexpr Time kEarlyChips = 8;     // a preamble so soon after the first light is the frame's own

constexpr const char* kFramesHeader =
    "t_s,end_s,sender,receiver,distance_m,level_counts,carrier,receivers,heard,overlap,receiver_sending";

}  // namespace

IrFrames::IrFrames(const IrMedium& medium, const std::string& file)
    : medium_(medium), senders_(medium.board_count()), counts_(medium.board_count()) {
    for (std::size_t i = 0; i < medium.board_count(); ++i)
        chip_.push_back(cosim::from_seconds(medium.parameters(i).chip));
    if (!file.empty()) csv_ = std::make_unique<CsvFile>(file, kFramesHeader);
}

void IrFrames::begin(std::size_t sender, Time start) {
    auto& frame = senders_[sender].frame.emplace();
    frame.sender = sender;
    frame.start = start;
    frame.at.resize(senders_.size());
}

bool IrFrames::edge(Time now, std::size_t sender, bool lit) {
    Sender& s = senders_[sender];
    if (lit == s.lit) return false;
    s.lit = lit;
    if (lit) {
        s.run_start = now;
        if (s.frame) {
            s.run_before = s.frame->end;
            s.frame->end = cosim::kNever;
            return false;
        }
        begin(sender, now);
        return true;
    }
    const Time chip = chip_[sender];
    const bool preamble = now - s.run_start >= kPreambleChips * chip;
    const bool another = preamble && s.run_start - s.frame->start > kEarlyChips * chip;
    if (another) {
        const std::vector<Heard> at = s.frame->at;
        s.frame->end = s.run_before;
        close(sender);
        begin(sender, s.run_start);
        s.frame->at = at;
    }
    s.frame->end = now;
    return another;
}

void IrFrames::seen(std::size_t sender) {
    auto& frame = senders_[sender].frame;
    if (!frame) return;
    for (std::size_t r = 0; r < medium_.listener_count(); ++r) {
        Heard& heard = frame->at[r];
        heard.distance = r == sender ? 0.0 : medium_.distance(sender, r);
        if (!medium_.coupled(sender, r)) continue;
        const IrLight& light = medium_.from(sender, r);
        const auto threshold = static_cast<float>(medium_.parameters(r).threshold);
        for (std::size_t k = 0; k < kIrSensors; ++k) {
            heard.level = std::max(heard.level, light.level[k]);
            heard.carrier = std::max(heard.carrier, light.carrier[k] / threshold);
            if (light.carrier[k] >= threshold)
                heard.receivers = static_cast<std::uint16_t>(heard.receivers | 1U << k);
        }
    }
}

void IrFrames::close_until(Time now) {
    for (;;) {
        std::size_t first = senders_.size();
        for (std::size_t i = 0; i < senders_.size(); ++i) {
            const Sender& s = senders_[i];
            if (!s.frame || s.lit || s.frame->end + kDarkEndChips * chip_[i] >= now) continue;
            if (first == senders_.size() || s.frame->end < senders_[first].frame->end) first = i;
        }
        if (first == senders_.size()) return;
        close(first);
    }
}

void IrFrames::close(std::size_t sender) {
    const Frame frame = std::move(*senders_[sender].frame);
    senders_[sender].frame.reset();
    write(frame);
    past_.push_back(frame);
    Time oldest = cosim::kNever;
    for (const Sender& s : senders_)
        if (s.frame) oldest = std::min(oldest, s.frame->start);
    // A frame split off a burst may begin a little before now; none reaches back over the end of this one.
    oldest = std::min(oldest, frame.end);
    std::erase_if(past_, [oldest](const Frame& past) { return past.end < oldest; });
}

std::vector<const IrFrames::Frame*> IrFrames::beside(const Frame& frame) const {
    std::vector<const Frame*> found;
    const auto look = [&](const Frame& other) {
        if (other.sender != frame.sender && other.start < frame.end && other.end > frame.start)
            found.push_back(&other);
    };
    std::for_each(past_.begin(), past_.end(), look);
    for (const Sender& s : senders_)
        if (s.frame) look(*s.frame);
    return found;
}

void IrFrames::write(const Frame& frame) {
    for (std::size_t r = 0; r < medium_.listener_count(); ++r) {
        const bool own = r == frame.sender;
        if (!own || frame.at[r].receivers != 0) write(frame, r);
    }
    if (csv_) csv_->flush();
}

void IrFrames::write(const Frame& frame, std::size_t receiver) {
    const Heard& heard = frame.at[receiver];
    const bool can_hear = heard.receivers != 0;
    bool sending = receiver == frame.sender;
    std::vector<bool> others(senders_.size());
    for (const Frame* other : beside(frame)) {
        if (other->sender == receiver) sending = true;
        if (other->at[receiver].receivers != 0) others[other->sender] = true;
    }
    std::string overlap;
    for (std::size_t i = 0; i < others.size(); ++i)
        if (others[i]) overlap += (overlap.empty() ? "" : "+") + medium_.name(i);

    Count& count = counts_[receiver];
    if (receiver == frame.sender) {
        ++count.own_heard;
    } else {
        ++count.frames;
        if (can_hear) {
            ++count.heard;
            if (!overlap.empty()) ++count.overlapped;
            count.longest = std::max(count.longest, cosim::to_seconds(frame.end - frame.start));
            count.farthest = std::max(count.farthest, heard.distance);
        }
    }
    if (!csv_) return;
    csv_->row(fmt::format("{:.6f},{:.6f},{},{},{:.4f},{:.0f},{:.3f},{},{},{},{}",
                          cosim::to_seconds(frame.start), cosim::to_seconds(frame.end),
                          medium_.name(frame.sender), medium_.name(receiver), heard.distance, heard.level,
                          heard.carrier, std::popcount(heard.receivers), can_hear ? 1 : 0, overlap,
                          sending ? 1 : 0));
}

std::string IrFrames::finish() {
    settle();
    for (std::size_t i = 0; i < senders_.size(); ++i)
        if (senders_[i].lit) edge(senders_[i].run_start, i, false);  // cut off: ends where it was last seen
    close_until(cosim::kNever);
    auto report = nlohmann::ordered_json::array();
    for (std::size_t r = 0; r < medium_.listener_count(); ++r) {
        const Count& c = counts_[r];
        report.push_back({{"receiver", medium_.name(r)},
                          {"frames", c.frames},
                          {"above_threshold", c.heard},
                          {"below_threshold", c.frames - c.heard},
                          {"collisions", c.overlapped},
                          {"own_heard", c.own_heard},
                          {"longest_frame_s", c.longest},
                          {"farthest_heard_m", c.farthest}});
    }
    return report.dump();
}

}  // namespace puckloop::physics
