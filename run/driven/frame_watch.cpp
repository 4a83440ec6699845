#include "run/driven/frame_watch.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "cosim/trace/trace_csv.h"
#include "cosim/trace/trace_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr std::array<std::string_view, 5> kKeys{"link", "from", "kind", "value", "signal"};

/// Columns of a row without quotes; the detail is the last but four and holds no comma.
std::vector<std::string_view> columns_of(std::string_view row) {
    std::vector<std::string_view> columns;
    for (std::size_t at = 0; at <= row.size();) {
        const std::size_t end = std::min(row.find(',', at), row.size());
        columns.push_back(row.substr(at, end - at));
        at = end + 1;
    }
    return columns;
}

const cosim::PortRef& sender_of(const cosim::TraceRecord& record, const std::vector<cosim::LinkSpec>& links) {
    const cosim::LinkSpec& link = links[record.link];
    return record.direction == cosim::Direction::FromA ? link.a : link.b;
}

}  // namespace

ordered_json frame_json(const cosim::TraceRecord& record, const std::vector<cosim::LinkSpec>& links) {
    const std::string row = cosim::to_csv(cosim::to_row(record, links));
    const auto values = columns_of(row), names = columns_of(cosim::kTraceColumns);
    ordered_json frame{{"time_ps", record.time}};
    for (std::size_t i = 0; i < std::min(values.size(), names.size()); ++i)
        if (!values[i].empty()) frame[std::string(names[i])] = values[i];
    if (frame.value("kind", "") == "signal") frame["signal"] = frame.value("detail", "");
    return frame;
}

FrameFilter::FrameFilter(const json& keys, const std::vector<cosim::LinkSpec>& links)
    : keys_(ordered_json::object()) {
    if (!keys.is_object()) throw InputError("", "frame", "is no filter", R"({"link": "robot0.uart"})");
    for (const auto& [key, value] : keys.items()) {
        if (std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
            throw InputError(
                "", "frame", fmt::format("no key '{}'", key),
                fmt::format("{}{}", fmt::join(kKeys, ", "), did_you_mean(key, {kKeys.begin(), kKeys.end()})));
        if (!value.is_string()) throw InputError("", key, "is no text", "a text");
        keys_[key] = value.get<std::string>();
    }
    const std::string link = keys_.value("link", "");
    std::vector<std::string_view> known;
    for (const cosim::LinkSpec& one : links)
        known.push_back(one.name);
    if (!link.empty() && std::find(known.begin(), known.end(), link) == known.end())
        throw InputError("", "link", fmt::format("there is no link '{}'", link),
                         "a link of the run" + did_you_mean(link, known));
}

bool FrameFilter::may_match(std::string_view link, std::string_view from) const {
    const auto is = [&](const char* key, std::string_view value) {
        const auto wanted = keys_.find(key);
        return wanted == keys_.end() || *wanted == value;
    };
    return is("link", link) && is("from", from);
}

bool FrameFilter::matches(const ordered_json& frame) const {
    for (const auto& [key, value] : keys_.items()) {
        const auto has = frame.find(key);
        if (has == frame.end() || *has != value) return false;
    }
    return true;
}

std::vector<ordered_json> FrameWatch::take(std::size_t& lost) {
    lost = std::exchange(lost_, 0);
    return std::exchange(captured_, {});
}

void FrameWatch::wait_for(FrameFilter filter, std::string text) {
    wanted_ = std::move(filter);
    text_ = ByteMatch(std::move(text));
    found_ = nullptr;
    seen_ = false;
    waits_ = true;
}

void FrameWatch::go_back(cosim::Time time) {
    std::erase_if(captured_, [time](const ordered_json& frame) {
        return frame.at("time_ps").get<cosim::Time>() >= time;
    });
    known_ = time;
    waits_ = false;
}

void FrameWatch::record(const cosim::TraceRecord& record) {
    if (record.time < known_) return;
    const std::string& link = links_[record.link].name;
    const std::string& from = sender_of(record, links_).node;
    const bool wanted = waits_ && !seen_ && wanted_.may_match(link, from);
    const bool captured =
        std::any_of(captured_by_.begin(), captured_by_.end(),
                    [&](const FrameFilter& filter) { return filter.may_match(link, from); });
    if (!wanted && !captured) return;
    ordered_json frame = frame_json(record, links_);
    if (wanted && wanted_.matches(frame)) {
        if (!text_.has_text()) {
            seen_ = true;
            found_ = frame;
        } else if (const auto* uart = std::get_if<cosim::UartFrame>(&record.payload);
                   uart != nullptr && !lost(record)) {
            seen_ = text_.add(static_cast<char>(uart->data));
        }
    }
    const bool kept =
        captured && std::any_of(captured_by_.begin(), captured_by_.end(),
                                [&](const FrameFilter& filter) { return filter.matches(frame); });
    if (!kept) return;
    if (captured_.size() < kMostFrames)
        captured_.push_back(std::move(frame));
    else
        ++lost_;
}

}  // namespace puckloop::tools
