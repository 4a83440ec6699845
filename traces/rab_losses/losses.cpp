#include "traces/rab_losses/losses.h"

#include <algorithm>
#include <optional>

namespace puckloop::tools {

using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Time;

namespace {

// Times of the board's firmware, from the end of the last light of a frame.
constexpr Time kEarliestMessage = 200 * kMicrosecond;  // the original needs 2.9 ms
constexpr Time kLatestMessage = 8 * kMillisecond;      // the same, with much service of the bus
constexpr Time kPeaksRead = 2'450 * kMicrosecond;      // earliest start of another frame that is decoded
constexpr Time kEndOfFrame = 300 * kMicrosecond;       // three dark samples end it
// An overlap with the service of the bus that moves a sample or a chip.
constexpr Time kFelt = 20 * kMicrosecond;
constexpr Time kNotFetched = 50 * kMillisecond;
constexpr Time kLongestWait = 10 * cosim::kSecond;  // of a message for its host
// A request that has waited longer was dropped: the queue holds ten frames of 8 ms.
constexpr Time kLongestQueue = 150 * kMillisecond;

constexpr std::array<std::string_view, kCauses> kNames{"below_threshold",  "queue_full",   "collision",
                                                       "receiver_peaks",   "receiver_i2c", "sender_i2c",
                                                       "receiver_sending", "after_error",  "other"};

/// Does the service of the bus take part of [begin, end)?
bool disturbed(const std::vector<Busy>& busy, Time begin, Time end) {
    const auto first = std::lower_bound(busy.begin(), busy.end(), begin,
                                        [](const Busy& service, Time time) { return service.end < time; });
    for (auto service = first; service != busy.end() && service->begin < end; ++service)
        if (std::min(service->end, end) - std::max(service->begin, begin) >= kFelt) return true;
    return false;
}

/// Frames of each sender in their order, with the payload its host asked for.
class Payloads {
  public:
    Payloads(const std::vector<HeardFrame>& frames, const std::map<std::string, BoardTraffic>& boards) {
        std::map<std::string, std::vector<Time>> starts;
        for (const HeardFrame& frame : frames)
            starts[frame.sender].push_back(frame.start);
        for (auto& [sender, times] : starts) {
            std::sort(times.begin(), times.end());
            times.erase(std::unique(times.begin(), times.end()), times.end());
            const auto traffic = boards.find(sender);
            if (traffic == boards.end()) continue;
            assign(sender, times, traffic->second.sends);
        }
    }
    std::optional<std::uint32_t> of(const HeardFrame& frame) const {
        const auto found = payloads_.find({frame.sender, frame.start});
        return found == payloads_.end() ? std::nullopt : found->second;
    }

  private:
    /// The board sends in order what it was asked to; each frame is the first request not sent yet.
    void assign(const std::string& sender, const std::vector<Time>& starts, const std::vector<Send>& sends) {
        std::size_t next = 0;
        for (const Time start : starts) {
            while (next < sends.size() && sends[next].time < start - kLongestQueue)
                ++next;
            if (next >= sends.size() || sends[next].time > start) continue;  // nobody asked for this one
            payloads_[{sender, start}] = sends[next++].payload;
        }
    }
    std::map<std::pair<std::string, Time>, std::optional<std::uint32_t>> payloads_;
};

bool carries(const std::optional<std::uint32_t>& payload, const Poll& poll) {
    return !payload || (*payload & poll.payload_mask) == poll.payload;
}

/// Finds the frame of each message of one receiver; its frames are in order of their ends.
std::uint64_t deliver(std::vector<Fate*>& fates, const std::vector<Poll>& polls, const Payloads& payloads) {
    std::uint64_t unexplained = 0;
    Time empty = 0;  // nothing was waiting then
    std::size_t first = 0;
    for (const Poll& poll : polls) {
        if (!poll.message) {
            empty = poll.time;
            continue;
        }
        bool found = false;
        for (std::size_t f = first; f < fates.size(); ++f) {
            const HeardFrame& frame = fates[f]->frame;
            if (frame.end + kEarliestMessage > poll.time) break;
            if (!frame.heard || frame.end + kLatestMessage < empty || !carries(payloads.of(frame), poll))
                continue;
            fates[f]->delivered = found = true;
            fates[f]->fetched = poll.time;
            first = f + 1;
            break;
        }
        unexplained += found ? 0 : 1;
    }
    return unexplained;
}

/// Ten messages fit. Frames with the same bytes cannot be distinguished, so two of them may be mistaken.
bool queue_full(const std::vector<Fate*>& fates, std::size_t index) {
    constexpr std::size_t kQueue = 10, kDoubt = 2;
    std::size_t waiting = 0;
    for (std::size_t f = index; f-- > 0 && fates[index]->frame.end - fates[f]->frame.end < kLongestWait;)
        waiting += fates[f]->delivered && fates[f]->fetched > fates[index]->frame.end ? 1 : 0;
    return waiting >= kQueue - kDoubt;
}

void find_conditions(std::vector<Fate*>& fates, const std::map<std::string, BoardTraffic>& boards) {
    const auto busy = [&boards](const std::string& robot) -> const std::vector<Busy>& {
        static const std::vector<Busy> kNone;
        const auto found = boards.find(robot);
        return found == boards.end() ? kNone : found->second.busy;
    };
    const Fate* before = nullptr;  // the last one that could be heard
    for (std::size_t index = 0; index < fates.size(); ++index) {
        Fate* fate = fates[index];
        const HeardFrame& frame = fate->frame;
        const auto meets = [fate](Cause cause, bool yes) {
            fate->met[static_cast<std::size_t>(cause)] = yes;
        };
        meets(Cause::BelowThreshold, !frame.heard);
        meets(Cause::QueueFull, !fate->delivered && queue_full(fates, index));
        meets(Cause::Collision, frame.overlapped);
        meets(Cause::ReceiverSending, frame.receiver_sending);
        meets(Cause::ReceiverPeaks, before != nullptr && frame.start >= before->frame.end &&
                                        frame.start - before->frame.end < kPeaksRead);
        meets(Cause::ReceiverI2c, disturbed(busy(frame.receiver), frame.start, frame.end + kEndOfFrame));
        meets(Cause::SenderI2c, disturbed(busy(frame.sender), frame.start, frame.end));
        meets(Cause::AfterError, before != nullptr && !before->delivered);
        const auto first = std::find(fate->met.begin(), fate->met.end(), true);
        fate->cause = first == fate->met.end() ? Cause::Other : static_cast<Cause>(first - fate->met.begin());
        if (frame.heard) before = fate;
    }
}

}  // namespace

std::string_view name_of(Cause cause) {
    return kNames[static_cast<std::size_t>(cause)];
}

Losses explain(const std::vector<HeardFrame>& frames, const std::map<std::string, BoardTraffic>& boards,
               Time end) {
    Losses losses;
    const Payloads payloads(frames, boards);
    for (const HeardFrame& frame : frames)
        losses.fates.push_back({frame, false, 0, Cause::Other, {}});
    std::stable_sort(losses.fates.begin(), losses.fates.end(),
                     [](const Fate& a, const Fate& b) { return a.frame.end < b.frame.end; });
    std::map<std::string, std::vector<Fate*>> of_receiver;
    for (Fate& fate : losses.fates)
        of_receiver[fate.frame.receiver].push_back(&fate);
    std::map<std::string, Time> known;  // until when everything has been fetched, by receiver
    for (auto& [receiver, fates] : of_receiver) {
        known[receiver] = end - kNotFetched;
        const auto board = boards.find(receiver);
        if (board != boards.end())
            losses.unexplained[receiver] = deliver(fates, board->second.polls, payloads);
        find_conditions(fates, boards);
        if (board == boards.end() || board->second.polls.empty() || !board->second.polls.back().message)
            continue;
        for (const Fate* fate : fates)  // more may have been waiting behind the last one
            if (fate->delivered && fate->fetched == board->second.polls.back().time)
                known[receiver] = std::min(known[receiver], fate->frame.end);
    }
    std::erase_if(losses.fates,
                  [&known](const Fate& fate) { return fate.frame.end > known.at(fate.frame.receiver); });
    return losses;
}

}  // namespace puckloop::tools
