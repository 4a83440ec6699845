#include "run/expectations/line_watch.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::tools {

LineWatch::LineWatch(const std::vector<scenarios::Expectation>& expected) : expected_(expected) {
    for (std::size_t i = 0; i < expected.size(); ++i) {
        if (expected[i].kind != scenarios::Expectation::Kind::Line) continue;
        const ByteMatch match(expected[i].text);
        watches_.push_back({.index = i, .matches = {match, match}});
    }
}

const LineWatch::Watch* LineWatch::watch_of(std::size_t index) const {
    for (const Watch& watch : watches_)
        if (watch.index == index) return &watch;
    return nullptr;
}

std::optional<double> LineWatch::seen_at(std::size_t index) const {
    const Watch* watch = watch_of(index);
    return watch == nullptr ? std::nullopt : watch->seen;
}

std::string LineWatch::what_came(std::size_t index) const {
    const Watch* watch = watch_of(index);
    if (watch == nullptr || watch->came == 0) return "no byte came";
    std::vector<unsigned char> bytes(watch->last.begin(), watch->last.end());
    return fmt::format("{} came, the last {:02X}",
                       watch->came == 1 ? "1 byte" : fmt::format("{} bytes", watch->came),
                       fmt::join(bytes, " "));
}

void LineWatch::begin(const std::vector<cosim::LinkSpec>& links) {
    links_ = links;
    for (Watch& watch : watches_)
        for (std::size_t i = 0; i < links.size(); ++i)
            if (links[i].name == expected_[watch.index].subject) watch.link = i;
}

void LineWatch::record(const cosim::TraceRecord& record) {
    const auto* frame = std::get_if<cosim::UartFrame>(&record.payload);
    if (frame == nullptr || cosim::lost(record) || frame->is_break != 0) return;
    for (Watch& watch : watches_) {
        if (watch.link != record.link || watch.seen) continue;
        const scenarios::Expectation& expected = expected_[watch.index];
        const cosim::LinkSpec& link = links_[record.link];
        const bool from_a = record.direction == cosim::Direction::FromA;
        if (!expected.from.empty() && expected.from != (from_a ? link.a : link.b).node) continue;
        const double time = cosim::to_seconds(record.time);
        const bool complete = watch.matches[from_a ? 0 : 1].add(static_cast<char>(frame->data));
        if (time >= expected.after && time <= expected.by) {
            ++watch.came;
            watch.last += static_cast<char>(frame->data);
            if (watch.last.size() > kShown) watch.last.erase(0, 1);
        }
        if (complete && time >= expected.after && time <= expected.by) watch.seen = time;
    }
}

}  // namespace puckloop::tools
