#include "linuxboard/netmanager/traffic.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

namespace puckloop::netmanager {

namespace {

constexpr std::size_t kMostRecent = 100'000;  // of a link
constexpr std::size_t kShown = 40;            // octets of a message

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

/// As JSON; what is not printable ASCII as its number.
std::string quoted(const std::string& data) {
    std::string text = "\"";
    for (const char c : data.substr(0, kShown)) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            text += '\\';
            text += c;
        } else if (byte >= ' ' && byte < 0x7f) {
            text += c;
        } else {
            char escaped[8];
            std::snprintf(escaped, sizeof escaped, "\\u%04x", byte);
            text += escaped;
        }
    }
    return text + '"';
}

/// "[1,2,3]"; `text` holds the rest of the row already, or nothing.
template <typename... Numbers>
std::string row(Numbers... numbers) {
    std::string text;
    ((text += (text.empty() ? "[" : ",") + number(static_cast<double>(numbers))), ...);
    return text;
}

}  // namespace

void Traffic::add(double time, int from, int to, int hops, const std::string& data, const char* fate) {
    Link& link = links_[{from, to}];
    const bool passed = std::string_view(fate) == "passed";
    ++(passed ? link.passed : link.failed);
    if (passed) {
        link.recent.push_back(time);
        if (link.recent.size() > kMostRecent) link.recent.pop_front();
    }
    last_.push_back({time, from, to, hops, data, fate});
    if (last_.size() > kKept) last_.pop_front();
}

std::string Traffic::status(double time, const Settings& settings, const Places& places) {
    std::string text = "{\"time_s\":" + number(time);
    text += ",\"range_m\":" + (settings.limits.range ? number(*settings.limits.range) : "null");
    text += ",\"hops\":" + std::to_string(settings.limits.hops);
    text += ",\"delay_s\":" + number(std::chrono::duration<double>(settings.hop_delay).count());
    text += ",\"loss\":" + number(settings.loss) + ",\"robots\":[";
    const char* between = "";
    for (const auto& [robot, place] : places) {
        text += std::exchange(between, ",") + (place ? row(robot, place->x, place->y) : row(robot)) + "]";
    }
    text += "],\"links\":[";
    between = "";
    for (const auto& [from, place] : places) {
        const auto hops = reached(places, from, settings.limits);
        for (const auto& [to, other] : places) {
            if (from == to) continue;
            Link& link = links_[{from, to}];
            while (!link.recent.empty() && link.recent.front() <= time - kWindow)
                link.recent.pop_front();
            const double rate =
                static_cast<double>(link.recent.size()) / std::min(kWindow, std::max(time, 1.0));
            const auto way = hops.find(to);
            text += std::exchange(between, ",") +
                    row(from, to, way == hops.end() ? 0 : way->second, link.passed, link.failed, rate,
                        settings.loss_between(from, to)) +
                    "]";
        }
    }
    text += "],\"last\":[";
    between = "";
    for (const Last& one : last_)
        text += std::exchange(between, ",") + row(one.time, one.from, one.to, one.hops, one.data.size()) +
                "," + quoted(one.fate) + "," + quoted(one.data) + "]";
    return text + "]}";
}

}  // namespace puckloop::netmanager
