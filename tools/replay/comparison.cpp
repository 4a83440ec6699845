#include "tools/replay/comparison.h"

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

}  // namespace

void SentComparison::recorded(const TraceRow& row) {
    links_[row.link].recorded.push_back(row);
}

void SentComparison::replayed(const TraceRow& row) {
    links_[row.link].replayed.push_back(row);
}

std::optional<ReplayDifference> SentComparison::check(cosim::Time end) {
    std::optional<ReplayDifference> first;
    for (auto& [name, link] : links_) {
        const auto found = check(name, link, end);
        if (found && (!first || found->time < first->time)) first = found;
    }
    return first;
}

std::optional<ReplayDifference> SentComparison::check(const std::string& name, Link& link, cosim::Time end) {
    while (!link.recorded.empty() && !link.replayed.empty()) {
        const TraceRow& then = link.recorded.front();
        const TraceRow& now = link.replayed.front();
        if (then.fault != FaultKind::None) {
            const bool message = shows_a_message(then, now);
            link.recorded.pop_front();
            if (message) {
                link.replayed.pop_front();
                ++link.messages;
            }
            continue;
        }
        ++link.messages;
        const std::string was = text_of(then), is = text_of(now);
        if (was != is) return ReplayDifference{std::min(then.time, now.time), name, link.messages, was, is};
        ++equal_;
        link.recorded.pop_front();
        link.replayed.pop_front();
    }
    // A row that the fault itself made has no message.
    while (!link.recorded.empty() && link.recorded.front().fault != FaultKind::None &&
           link.replayed.empty() && link.recorded.front().time < end)
        link.recorded.pop_front();
    if (!link.recorded.empty() && link.recorded.front().time < end)
        return ReplayDifference{
            link.recorded.front().time, name, link.messages + 1, text_of(link.recorded.front()), {}};
    if (!link.replayed.empty() && link.replayed.front().time < end)
        return ReplayDifference{
            link.replayed.front().time, name, link.messages + 1, {}, text_of(link.replayed.front())};
    return std::nullopt;
}

}  // namespace puckloop::tools
