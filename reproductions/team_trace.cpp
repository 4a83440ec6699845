#include "reproductions/team_trace.h"

#include "protocols/network/ip_packet.h"

#include <fmt/format.h>

#include <charconv>

namespace puckloop::tools {

namespace {

constexpr char kLineEnd = '\r';

double in_seconds(cosim::Time time) {
    return cosim::to_seconds(time);
}

/// "NUMBER DATA"; the number, and `line` is left as the data. -2: it is no such line.
int take_number(std::string_view& line) {
    int number = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), number);
    if (error != std::errc() || end == line.data() + line.size() || *end != ' ') return -2;
    line.remove_prefix(static_cast<std::size_t>(end - line.data()) + 1);
    return number;
}

void set_first(double& place, double time) {
    if (place < 0) place = time;
}

}  // namespace

TeamTrace::TeamTrace(std::size_t robots, std::string manager)
    : manager_(std::move(manager)), up_(robots), down_(robots) {
    for (std::size_t i = 0; i < robots; ++i) {
        boards_[fmt::format("robot{}.pic", i)] = i;
        computers_[fmt::format("robot{}.linux", i)] = i;
    }
}

void TeamTrace::add(const cosim::TraceRow& row) {
    if (const auto* frame = std::get_if<cosim::UartFrame>(&row.payload)) {
        if (!row.link.ends_with(".uart")) return;
        const auto character = static_cast<char>(frame->data);
        if (const auto board = boards_.find(row.from); board != boards_.end())
            from_board(board->second, character, row);
        else if (const auto computer = computers_.find(row.from); computer != computers_.end())
            to_board(computer->second, character, row);
    } else if (const auto* one = std::get_if<cosim::Packet>(&row.payload)) {
        packet(*one, row);
    }
}

void TeamTrace::from_board(std::size_t robot, char character, const cosim::TraceRow& row) {
    constexpr int kAll = -1, kAllByFourDigits = 9999;
    Line& line = up_[robot];
    if (character != kLineEnd) {
        if (line.text.empty()) line.begun = in_seconds(std::get<cosim::UartFrame>(row.payload).start);
        line.text += character;
        return;
    }
    std::string_view data = line.text;
    if (const int to = take_number(data); to == kAll || to == kAllByFourDigits) {
        known_[{robot, std::string(data)}] = messages_.size();
        messages_.push_back(
            {robot, std::string(data), line.begun, in_seconds(row.time), std::vector<Arrival>(up_.size())});
    }
    line = {};
}

void TeamTrace::to_board(std::size_t robot, char character, const cosim::TraceRow& row) {
    Line& line = down_[robot];
    if (character != kLineEnd) {
        line.text += character;
        return;
    }
    if (TeamMessage* message = find(line.text))
        set_first(message->arrivals[robot].received, in_seconds(row.time));
    line = {};
}

TeamMessage* TeamTrace::find(std::string_view line) {
    const int number = take_number(line);
    if (number < 1) return nullptr;
    const auto known = known_.find({static_cast<std::size_t>(number) - 1, std::string(line)});
    return known == known_.end() ? nullptr : &messages_[known->second];
}

/// Of the manager to a robot: the lines in it.
void TeamTrace::packet(const cosim::Packet& packet, const cosim::TraceRow& row) {
    const bool passed = row.from == manager_ + ".linux";
    if (!passed && !row.link.starts_with("robot")) return;
    const auto read = protocols::decode_ip(packet.octets.view());
    if (!read || read->protocol != protocols::kTcp) return;
    const auto segment = protocols::decode_tcp(*read);
    if (!segment) return;
    const std::size_t to = (read->to & 0xff) - 1;
    if (to >= up_.size()) return;
    std::string_view rest = segment->data;
    for (std::size_t end; (end = rest.find(kLineEnd)) != std::string_view::npos; rest.remove_prefix(end + 1))
        if (TeamMessage* message = find(rest.substr(0, end)))
            set_first(passed ? message->arrivals[to].passed : message->arrivals[to].arrived,
                      in_seconds(row.time));
}

}  // namespace puckloop::tools
