#include "replay/comparison.h"

#include <algorithm>

namespace puckloop::tools {

using cosim::FaultKind;
using cosim::TraceRow;

namespace {

std::string text_of(TraceRow row) {
    row.fault = FaultKind::None;
    return to_csv(row);
}

/// Whether a harmed row still is one message of the sender.
bool shows_a_message(const TraceRow& recorded, const TraceRow& replayed) {
    if (recorded.payload == replayed.payload) return true;
    switch (recorded.fault) {
    case FaultKind::Duplicate:
    case FaultKind::Insert:
    case FaultKind::Swap:  // the one kept back has a row of its own
    case FaultKind::FalseStart:
        return false;
    case FaultKind::Stuck: {
        const auto* frame = std::get_if<cosim::UartFrame>(&recorded.payload);
        return frame == nullptr || frame->is_break == 0;
    }
    default:
        return true;
    }
}

/// But for when it was on the line.
bool same_content(const TraceRow& recorded, const TraceRow& replayed) {
    const auto* then = std::get_if<cosim::UartFrame>(&recorded.payload);
    const auto* now = std::get_if<cosim::UartFrame>(&replayed.payload);
    if (then == nullptr || now == nullptr) return recorded.payload == replayed.payload;
    return then->data == now->data && then->is_break == now->is_break && then->data_bits == now->data_bits;
}

// A fault that delays longer than this is one that loses.
constexpr cosim::Time kLongestDelay = cosim::kSecond;

}  // namespace

SentComparison::Link& SentComparison::link(const std::string& name) {
    const auto [found, is_new] = links_.try_emplace(name);
    if (is_new) found->second.faults = with_faults_.contains(name);
    return found->second;
}

void SentComparison::recorded(const TraceRow& row) {
    link(row.link).recorded.push_back(row);
}

void SentComparison::replayed(const TraceRow& row) {
    link(row.link).replayed.push_back(row);
}

std::optional<ReplayDifference> SentComparison::check(cosim::Time end) {
    std::optional<ReplayDifference> first;
    for (auto& [name, link] : links_) {
        const auto found = check(name, link, end);
        if (found && (!first || found->time < first->time)) first = found;
    }
    return first;
}

/// A row that a fault harmed: what is outstanding first, then what was sent last.
void SentComparison::take_harmed(Link& link) {
    const TraceRow then = link.recorded.front();
    const auto outstanding = std::find_if(link.outstanding.begin(), link.outstanding.end(),
                                          [&](const TraceRow& row) { return same_content(then, row); });
    const bool is_outstanding = outstanding != link.outstanding.end() &&
                                (link.replayed.empty() || !same_content(then, link.replayed.front()) ||
                                 outstanding->time < link.replayed.front().time);
    if (is_outstanding) {
        link.outstanding.erase(outstanding);
        ++link.messages;
    } else if (!link.replayed.empty() && shows_a_message(then, link.replayed.front())) {
        link.replayed.pop_front();
        ++link.messages;
    }
    link.recorded.pop_front();
}

/// False: the first row that no fault harmed is not what was sent. On a link with faults what was sent before
/// it may be late.
bool SentComparison::take_sound(Link& link) {
    const std::string was = text_of(link.recorded.front());
    const auto last = link.faults ? link.replayed.end() : link.replayed.begin() + 1;
    const auto found =
        std::find_if(link.replayed.begin(), last, [&](const TraceRow& row) { return text_of(row) == was; });
    if (found == last) return false;
    link.outstanding.insert(link.outstanding.end(), link.replayed.begin(), found);
    link.replayed.erase(link.replayed.begin(), found + 1);
    link.recorded.pop_front();
    ++link.messages;
    ++equal_;
    return true;
}

std::optional<ReplayDifference> SentComparison::check(const std::string& name, Link& link, cosim::Time end) {
    const auto harmed = [&] {
        return !link.recorded.empty() && link.recorded.front().fault != FaultKind::None;
    };
    while (!link.recorded.empty() && !link.replayed.empty()) {
        if (harmed()) {
            take_harmed(link);
        } else if (!take_sound(link)) {
            const TraceRow& then = link.recorded.front();
            const TraceRow& now = link.replayed.front();
            if (link.faults && then.time >= end) return std::nullopt;  // not sent yet
            return ReplayDifference{std::min(then.time, now.time), name, link.messages + 1, text_of(then),
                                    text_of(now)};
        }
    }
    // Late ones, and rows that the fault itself made, which have no message.
    while (harmed() && link.recorded.front().time < end)
        take_harmed(link);
    if (!link.recorded.empty() && link.recorded.front().time < end)
        return ReplayDifference{
            link.recorded.front().time, name, link.messages + 1, text_of(link.recorded.front()), {}};
    if (!link.faults && !link.replayed.empty() && link.replayed.front().time < end)
        return ReplayDifference{
            link.replayed.front().time, name, link.messages + 1, {}, text_of(link.replayed.front())};
    return std::nullopt;
}

std::optional<ReplayDifference> SentComparison::finish(cosim::Time end) const {
    std::optional<ReplayDifference> first;
    for (const auto& [name, link] : links_)
        for (const auto* rows : {&link.outstanding, &link.replayed})
            if (!rows->empty() && rows->front().time < end - kLongestDelay &&
                (!first || rows->front().time < first->time))
                first = {rows->front().time, name, link.messages + 1, {}, text_of(rows->front())};
    return first;
}

}  // namespace puckloop::tools
