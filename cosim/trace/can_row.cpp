#include "cosim/trace/can_row.h"

#include "protocols/can/can_reader.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <vector>

namespace puckloop::cosim {

namespace {

// In the order of CanKind.
constexpr std::array<std::string_view, 11> kKinds{"join",      "watch",     "leave",    "offer",
                                                  "withdraw",  "sent",      "received", "error",
                                                  "withdrawn", "recovered", "wake"};
constexpr std::size_t kLongDigits = 8;

bool joins(const CanMessage& message) {
    return message.kind == CanKind::Join;
}

bool carries_frame(const CanMessage& message) {
    return message.kind == CanKind::Offer || message.kind == CanKind::Sent ||
           message.kind == CanKind::Received ||
           (message.kind == CanKind::Error && (message.flags & kCanSender) != 0);
}

template <class T>
bool take_number(std::string_view text, T& value, int base = 10) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, value, base);
    return error == std::errc() && stop == end;
}

bool parse_timing(std::string_view text, CanMessage& message) {
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t slash = std::min(text.find('/'), text.size());
        if (!take_number(text.substr(0, slash), message.data[i])) return false;
        text.remove_prefix(std::min(slash + 1, text.size()));
    }
    return text.empty();
}

bool parse_frame(std::string_view text, CanMessage& message) {
    const std::size_t hash = text.find('#');
    if (hash == std::string_view::npos || !take_number(text.substr(0, hash), message.id, 16)) return false;
    constexpr std::uint32_t kIds = 1u << 29;
    if (message.id >= kIds || (hash != 3 && hash != kLongDigits)) return false;
    if (hash == kLongDigits) message.flags |= kCanExtended;
    text.remove_prefix(hash + 1);
    if (text.starts_with('R')) {
        message.flags |= kCanRemote;
        return take_number(text.substr(1), message.length) && message.length <= message.data.size();
    }
    message.length = static_cast<std::uint8_t>(text.size() / 2);
    if (text.size() % 2 != 0 || message.length > message.data.size()) return false;
    for (std::size_t i = 0; i < message.length; ++i)
        if (!take_number(text.substr(2 * i, 2), message.data[i], 16)) return false;
    return true;
}

std::vector<std::string_view> words_of(std::string_view text) {
    std::vector<std::string_view> words;
    while (!text.empty()) {
        const std::size_t space = std::min(text.find(' '), text.size());
        words.push_back(text.substr(0, space));
        text.remove_prefix(std::min(space + 1, text.size()));
    }
    return words;
}

}  // namespace

std::string_view can_kind_name(CanKind kind) {
    return kKinds.at(static_cast<std::size_t>(kind));
}

std::string can_data_text(const CanMessage& message) {
    if (joins(message)) return fmt::format("{}/{}/{}", message.data[0], message.data[1], message.data[2]);
    if (!carries_frame(message)) return {};
    std::string text = message.flags & kCanExtended ? fmt::format("{:08x}#", message.id)
                                                    : fmt::format("{:03x}#", message.id);
    if (message.flags & kCanRemote) return text + fmt::format("R{}", message.length);
    for (std::size_t i = 0; i < message.length; ++i)
        text += fmt::format("{:02x}", message.data[i]);
    return text;
}

std::string can_detail_text(const CanMessage& message) {
    std::string text = fmt::format("{} tag {} tec {} rec {}", can_kind_name(message.kind), message.tag,
                                   message.transmit_errors, message.receive_errors);
    if (message.flags & kCanSender) text += joins(message) ? " listens" : " sender";
    if (message.flags & kCanLost) text += " lost";
    if (message.flags & kCanGone) text += " gone";
    if (message.kind == CanKind::Error)
        text += fmt::format(" {} at {}",
                            can_error_name(static_cast<protocols::CanError>(message.flags >> kCanErrorShift)),
                            message.position);
    return text;
}

std::optional<CanMessage> parse_can(std::string_view data, std::string_view detail) {
    CanMessage message;
    const auto words = words_of(detail);
    constexpr std::size_t kFixed = 7;
    if (words.size() < kFixed || words[1] != "tag" || words[3] != "tec" || words[5] != "rec")
        return std::nullopt;
    std::size_t kind = 0;
    while (kind < kKinds.size() && kKinds[kind] != words[0])
        ++kind;
    if (kind == kKinds.size()) return std::nullopt;
    message.kind = static_cast<CanKind>(kind);
    if (!take_number(words[2], message.tag) || !take_number(words[4], message.transmit_errors) ||
        !take_number(words[6], message.receive_errors))
        return std::nullopt;
    for (std::size_t i = kFixed; i < words.size(); ++i) {
        if (words[i] == "sender" || words[i] == "listens") message.flags |= kCanSender;
        if (words[i] == "lost") message.flags |= kCanLost;
        if (words[i] == "gone") message.flags |= kCanGone;
        for (int error = 1; error <= kMostCanError; ++error)
            if (words[i] == can_error_name(static_cast<protocols::CanError>(error)))
                message.flags = static_cast<std::uint8_t>(message.flags | error << kCanErrorShift);
        if (words[i] == "at" && (i + 1 == words.size() || !take_number(words[i + 1], message.position)))
            return std::nullopt;
    }
    if (joins(message) && !parse_timing(data, message)) return std::nullopt;
    if (carries_frame(message) && !parse_frame(data, message)) return std::nullopt;
    if (can_data_text(message) != data || can_detail_text(message) != detail) return std::nullopt;
    return message;
}

}  // namespace puckloop::cosim
