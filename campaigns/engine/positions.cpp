#include "campaigns/engine/positions.h"

#include "protocols/serial/epuck_fields.h"
#include "scenarios/values/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace puckloop::faults {

using nlohmann::json;

namespace {

constexpr double kPause = 2.0;  ///< byte times between two records

/// Kinds that do something to a frame and nothing where there is none.
constexpr std::array kOnFrames{"drop",  "loss",    "flip", "corrupt",  "duplicate", "insert",
                               "swap",  "reorder", "cut",  "truncate", "parity",    "stop",
                               "delay", "rate",    "baud", "batch",    "throttle"};

double seconds(const json& fault, const char* key, double fallback) {
    if (!fault.contains(key) || !fault.at(key).is_string()) return fallback;
    try {
        return scenarios::parse_quantity(fault.at(key).get<std::string>(), scenarios::Dimension::Time);
    } catch (const scenarios::QuantityError&) {
        return fallback;
    }
}

int byte_value(const std::string& text) {
    try {
        return std::stoi(text, nullptr, 0);
    } catch (const std::exception&) {
        return -1;
    }
}

bool among(const json& bytes, const std::string& value) {
    const int sent = byte_value("0x" + value);
    return std::any_of(bytes.begin(), bytes.end(), [&](const json& byte) {
        return (byte.is_string() ? byte_value(byte.get<std::string>()) : -2) == sent;
    });
}

}  // namespace

std::vector<std::size_t> records_of(const Sender& sender) {
    std::vector<std::size_t> begins;
    double idle_from = -1;
    for (std::size_t i = 0; i < sender.times.size(); ++i) {
        const bool starts = i == 0 || sender.times[i] > idle_from + kPause * sender.frame_s[i];
        idle_from = sender.times[i] + sender.frame_s[i];
        if (starts) begins.push_back(i);
    }
    begins.push_back(sender.times.size());
    return begins;
}

namespace {

/// The record of the Linux board's protocol that byte number `byte` of `record` of these bytes belongs to,
/// and its place there; nothing if they are of another protocol.
std::optional<std::pair<protocols::EpuckRecord, std::size_t>>
epuck_place(const std::vector<std::size_t>& begins, std::size_t record, std::size_t byte,
            const std::string& from) {
    using protocols::EpuckRecord;
    const std::size_t here = begins[record + 1] - begins[record];
    if (from.ends_with(".pic"))
        return here == size_of(EpuckRecord::Sensors) ? std::optional(std::pair(EpuckRecord::Sensors, byte))
                                                     : std::nullopt;
    if (here == size_of(EpuckRecord::Actuators)) return std::pair(EpuckRecord::Actuators, byte);
    if (here == size_of(EpuckRecord::Session)) return std::pair(EpuckRecord::Session, byte);
    return std::nullopt;
}

/// A command's last byte may go by itself, as ARGoS' and the project's own programs write it: it is of the
/// same record.
void join_last_bytes(std::vector<std::size_t>& begins) {
    const std::size_t whole = size_of(protocols::EpuckRecord::Actuators);
    std::vector<std::size_t> joined;
    for (std::size_t i = 0; i < begins.size(); ++i) {
        const bool last_byte = i > 0 && i + 1 < begins.size() && begins[i + 1] - begins[i] == 1 &&
                               begins[i] - begins[i - 1] == whole - 1;
        if (!last_byte) joined.push_back(begins[i]);
    }
    begins = std::move(joined);
}

/// The other end of a Linux board's line sends sensor records: they speak that protocol.
bool speaks_epuck(const std::string& link, const Profile& nominal) {
    if (!link.ends_with(".uart")) return false;
    const std::string board = link.substr(0, link.size() - std::string(".uart").size()) + ".pic";
    const auto sender = nominal.senders.find(sender_name(link, board));
    if (sender == nominal.senders.end()) return false;
    const std::vector<std::size_t> begins = records_of(sender->second);
    for (std::size_t i = 0; i + 1 < begins.size(); ++i)
        if (begins[i + 1] - begins[i] == protocols::size_of(protocols::EpuckRecord::Sensors)) return true;
    return false;
}

}  // namespace

std::vector<Position> positions_of(const Sweep& sweep, const json& fault, const Profile& nominal) {
    const std::string name = sender_name(value_text(fault["link"]), value_text(fault["from"]));
    const auto found = nominal.senders.find(name);
    static const Sender kNobody{};
    const Sender& sender = found == nominal.senders.end() ? kNobody : found->second;
    std::vector<std::size_t> begins = records_of(sender);
    const std::string from = value_text(fault["from"]);
    const bool has_fields = speaks_epuck(value_text(fault["link"]), nominal);
    if (has_fields && !from.ends_with(".pic")) join_last_bytes(begins);
    std::erase_if(begins, [&](std::size_t first) {
        return first < sender.times.size() && sender.times[first] < sweep.after;
    });
    std::vector<Position> positions;
    for (const int record : sweep.records) {
        const auto r = static_cast<std::size_t>(record);
        const bool there = r + 1 < begins.size();
        const std::size_t length = there ? begins[r + 1] - begins[r] : 0;
        std::vector<int> bytes;
        if (sweep.bytes)
            bytes = *sweep.bytes;
        else
            for (std::size_t i = 0; i < std::max<std::size_t>(1, length); ++i)
                bytes.push_back(static_cast<int>(i));
        for (const int byte : bytes) {
            Position position{fmt::format("byte {}", byte), "0 s", ""};
            if (has_fields && there && byte >= 0 && static_cast<std::size_t>(byte) < length)
                if (const auto place = epuck_place(begins, r, static_cast<std::size_t>(byte), from))
                    position.name = fmt::format("{} {} ({})", name_of(place->first),
                                                field_at(place->first, place->second), position.name);
            if (sweep.records.size() > 1) position.name = fmt::format("record {} ", record) + position.name;
            if (!there)
                position.missing =
                    fmt::format("{} sends no {} records after {:g} s", name, record + 1, sweep.after);
            else if (static_cast<std::size_t>(byte) >= length)
                position.missing = fmt::format("a record of {} bytes", length);
            else
                position.begin = fmt::format(
                    "{:.6f} s",
                    std::floor(sender.times[begins[r] + static_cast<std::size_t>(byte)] * 1e6) / 1e6);
            positions.push_back(std::move(position));
        }
    }
    return positions;
}

namespace {

/// From when to when a fault may act, s.
std::pair<double, double> window_of(const json& fault) {
    const double begin = seconds(fault, fault.contains("at") ? "at" : "begin", 0);
    return {begin, fault.contains("for") ? begin + seconds(fault, "for", 1e9) : seconds(fault, "end", 1e9)};
}

/// Kinds that do something to a byte on a bus and nothing where there is none; others last.
constexpr std::array kOnBytes{"nack", "flip", "start", "stop", "stretch", "lose_arbitration", "slow_rise"};

/// Of a bus: transfers with a device that nobody addresses, by a master that makes none then, or none at all.
std::string useless_on_bus(const std::string& bus, const json& fault, const Profile& nominal) {
    bool any = false, meant = !fault.contains("address"), then = false;
    const auto [begin, end] = window_of(fault);
    const std::string from = fault.contains("from") ? " from " + value_text(fault["from"]) : "";
    for (const auto& [name, sender] : nominal.senders) {
        if (!name.starts_with(bus + ".")) continue;
        if (name.ends_with(from)) {
            const auto first = std::lower_bound(sender.times.begin(), sender.times.end(), begin);
            then = then || (first != sender.times.end() && *first < end);
        }
        for (const std::string& first : sender.addresses) {
            any = true;
            if (!meant && byte_value("0x" + first) >> 1 == byte_value(value_text(fault["address"])))
                meant = true;
        }
    }
    if (!any) return fmt::format("no transfer on {}", bus);
    const std::string kind = value_text(fault.value("kind", json("drop")));
    if (!then && std::find(kOnBytes.begin(), kOnBytes.end(), kind) != kOnBytes.end())
        return fmt::format("no transfer on {}{} in this window", bus, from);
    return meant ? std::string()
                 : fmt::format("nobody addresses {} on {}", value_text(fault["address"]), bus);
}

}  // namespace

std::string useless(const json& fault, const Profile& nominal) {
    if (fault.contains("link") && value_text(fault["link"]).ends_with(".i2c"))
        return useless_on_bus(value_text(fault["link"]), fault, nominal);
    const std::string kind = value_text(fault.value("kind", json("drop")));
    if (!fault.contains("link") || std::find(kOnFrames.begin(), kOnFrames.end(), kind) == kOnFrames.end())
        return {};
    const std::string link = value_text(fault["link"]);
    const auto [begin, end] = window_of(fault);
    bool any = false, value = !fault.contains("bytes");
    for (const auto& [name, sender] : nominal.senders) {
        const bool meant = fault.contains("from") ? name == sender_name(link, value_text(fault["from"]))
                                                  : name.starts_with(link + " from ");
        if (!meant) continue;
        for (std::size_t i = 0; i < sender.times.size(); ++i) {
            if (sender.times[i] < begin || sender.times[i] >= end) continue;
            any = true;
            if (!value && among(fault["bytes"], sender.values[i])) value = true;
            if (value) return {};
        }
    }
    const std::string sender = fault.contains("from") ? " from " + value_text(fault["from"]) : "";
    return any ? fmt::format("none of these bytes is sent on {}{} in this window", link, sender)
               : fmt::format("no frame on {}{} in this window", link, sender);
}

}  // namespace puckloop::faults
