#include "campaigns/engine/profile.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <string_view>

namespace puckloop::faults {

namespace {

using nlohmann::json;

/// Splits a line of a CSV file without quotes; missing columns are empty.
template <std::size_t N>
std::array<std::string_view, N> columns(std::string_view line) {
    std::array<std::string_view, N> parts{};
    for (std::size_t i = 0; i < N; ++i) {
        const auto comma = i + 1 == N ? line.npos : line.find(',');
        parts.at(i) = line.substr(0, comma);
        if (comma == line.npos) break;
        line.remove_prefix(comma + 1);
    }
    return parts;
}

double number(std::string_view text) {
    double value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// What a fault put on a line by itself shows nothing of the node whose end it is on.
bool nobody_sent(std::string_view fault) {
    return fault == "break" || fault == "false_start" || fault == "loopback";
}

void read_trace(const std::filesystem::path& file, Profile& profile) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    std::getline(in, line);
    bool starting = false;
    while (std::getline(in, line)) {
        const auto [time, link, from, kind, value, detail, start, period, stretch, fault] = columns<10>(line);
        const double begin = number(start.empty() ? time : start);
        if (!fault.empty() && (!profile.first_fault_s || begin < *profile.first_fault_s))
            profile.first_fault_s = begin;
        constexpr std::string_view kBoard = ".pic";
        if (kind == "signal" && detail.starts_with("wheel_") && from.ends_with(kBoard))
            profile.turns[std::string(from.substr(0, from.size() - kBoard.size()))].push_back(number(time));
        if (kind == "signal" || kind.empty() || nobody_sent(fault)) continue;
        Sender& sender = profile.senders[sender_name(std::string(link), std::string(from))];
        sender.times.push_back(begin);
        sender.values.emplace_back(value);
        sender.frame_s.push_back(kind == "uart" ? 10 * number(period) : 0.0);
        starting = kind == "i2c" && detail == "start";
        if (starting) sender.addresses.emplace(value);
    }
    for (auto& [robot, turns] : profile.turns)
        std::sort(turns.begin(), turns.end());
    // Frames of two kinds of time on one link may be a little out of order.
    for (auto& [name, sender] : profile.senders)
        if (!std::is_sorted(sender.times.begin(), sender.times.end())) {
            std::vector<std::size_t> order(sender.times.size());
            for (std::size_t i = 0; i < order.size(); ++i)
                order[i] = i;
            std::stable_sort(order.begin(), order.end(),
                             [&](auto a, auto b) { return sender.times[a] < sender.times[b]; });
            Sender sorted;
            for (const std::size_t i : order) {
                sorted.times.push_back(sender.times[i]);
                sorted.values.push_back(sender.values[i]);
                sorted.frame_s.push_back(sender.frame_s[i]);
            }
            sorted.addresses = sender.addresses;
            sender = std::move(sorted);
        }
}

void read_paths(const std::filesystem::path& file, Profile& profile) {
    std::ifstream in(file, std::ios::binary);
    std::string line;
    std::getline(in, line);
    while (std::getline(in, line)) {
        const auto [time, robot, x, y, theta] = columns<5>(line);
        profile.paths[std::string(robot)][std::string(time)] = {number(x), number(y)};
    }
}

/// "not answered 0, short 2": what a program counts in words, by the words before each number.
void count_in_line(const std::string& node, const std::string& line, Profile& profile) {
    std::string words;
    for (std::size_t i = 0; i < line.size();) {
        if (std::isdigit(static_cast<unsigned char>(line[i])) == 0) {
            words += line[i++];
            continue;
        }
        std::size_t end = i;
        while (end < line.size() &&
               (std::isdigit(static_cast<unsigned char>(line[end])) != 0 || line[end] == '.'))
            ++end;
        while (!words.empty() && std::isalpha(static_cast<unsigned char>(words.front())) == 0)
            words.erase(0, 1);
        while (!words.empty() && std::isalpha(static_cast<unsigned char>(words.back())) == 0)
            words.pop_back();
        if (names_error(words)) {
            double& counter = profile.error_counters[node + " " + words];
            counter = std::max(counter, number(std::string_view(line).substr(i, end - i)));
        }
        words.clear();
        i = end;
    }
}

void read_logs(const std::filesystem::path& folder, Profile& profile) {
    for (const auto& [node, content] : profile.report.at("nodes").items()) {
        if (!content.contains("program")) continue;
        std::ifstream in(folder / (node + ".log"), std::ios::binary);
        std::vector<std::string>& lines = profile.logs[node];
        std::string line;
        while (std::getline(in, line)) {
            profile.log_shapes.insert(node + ": " + shape_of(line));
            count_in_line(node, line, profile);
            lines.push_back(line);
        }
    }
}

void collect_counters(const json& value, const std::string& name, Profile& profile) {
    if (value.is_object()) {
        for (const auto& [key, item] : value.items())
            if (key != "devices" && key != "faults") collect_counters(item, name + "." + key, profile);
        return;
    }
    const std::string last = name.substr(name.rfind('.') + 1);
    if (value.is_array() && (last == "traps" || last == "refused_addresses"))
        profile.error_counters[name] = double(value.size());
    if (value.is_number() && names_error(last)) profile.error_counters[name] = value.get<double>();
}

}  // namespace

std::string sender_name(const std::string& link, const std::string& from) {
    return link + " from " + from;
}

std::string shape_of(const std::string& line) {
    std::string shape;
    for (std::size_t i = 0; i < line.size(); ++i) {
        const auto letter = static_cast<unsigned char>(line[i]);
        if (letter == 0x1B) {  // a colour: ESC [ ... m
            while (i < line.size() && line[i] != 'm')
                ++i;
            continue;
        }
        if (std::isdigit(letter) != 0) {
            if (shape.empty() || shape.back() != '#') shape += '#';
        } else if (letter == '.' && shape.ends_with('#') && i + 1 < line.size() &&
                   std::isdigit(static_cast<unsigned char>(line[i + 1])) != 0) {
            continue;  // of a number
        } else if (letter >= 0x20) {
            shape += line[i];
        }
    }
    return shape;
}

bool names_error(const std::string& name) {
    // "lost" of a bus, "errno" of a driver, "slips" of a program that looks for a record's begin.
    static constexpr std::array kWords{
        "error",   "overrun",     "lost",         "fail",    "not_acknowledged",
        "refused", "wrong",       "bad",          "short",   "slip",
        "stray",   "synchron",    "invalid",      "timeout", "corrupt",
        "missed",  "implausible", "not answered", "stuck",   "breaks",
        "dropped", "rejected",    "retries"};
    return std::any_of(kWords.begin(), kWords.end(),
                       [&](const char* word) { return name.find(word) != std::string::npos; });
}

Profile read_profile(const std::filesystem::path& folder) {
    Profile profile;
    std::ifstream in(folder / "report.json", std::ios::binary);
    profile.report = json::parse(in, nullptr, false);
    if (profile.report.is_discarded() || !profile.report.contains("nodes"))
        throw RunError(fmt::format("{}: the run left no report", (folder / "report.json").string()));
    read_trace(folder / "trace.csv", profile);
    read_paths(folder / "trajectory.csv", profile);
    read_logs(folder, profile);
    collect_counters(profile.report.at("nodes"), "nodes", profile);
    return profile;
}

std::optional<double> path_length(const Profile& profile, const std::string& robot) {
    const auto path = profile.paths.find(robot);
    if (path == profile.paths.end()) return std::nullopt;
    std::vector<std::pair<double, Pose>> poses;
    for (const auto& [time, pose] : path->second)
        poses.emplace_back(number(time), pose);
    std::sort(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    double length = 0;
    for (std::size_t i = 1; i < poses.size(); ++i)
        length +=
            std::hypot(poses[i].second.x - poses[i - 1].second.x, poses[i].second.y - poses[i - 1].second.y);
    return length;
}

}  // namespace puckloop::faults
