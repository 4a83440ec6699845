#include "linuxboard/netmanager/message.h"

#include <charconv>
#include <cmath>

namespace puckloop::netmanager {

namespace {

/// A number at the beginning of `text`, which is left without it.
template <typename T>
bool take(std::string_view& text, T& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return true;
}

bool take(std::string_view& text, char mark) {
    if (!text.starts_with(mark)) return false;
    text.remove_prefix(1);
    return true;
}

}  // namespace

std::optional<Message> parse_message(std::string_view line) {
    Message message;
    if (line.starts_with('\n')) line.remove_prefix(1);
    if (line.size() > kLongest || !take(line, message.to)) return std::nullopt;
    if (message.to == kEverybodyByFourDigits) message.to = kEverybody;
    if (message.to < kEverybody || message.to > kMostNumber) return std::nullopt;
    if (!line.empty() && !take(line, ' ')) return std::nullopt;
    if (line.starts_with('@')) {
        Place& place = message.place.emplace();
        take(line, '@');
        if (!take(line, place.x) || !take(line, ',') || !take(line, place.y)) return std::nullopt;
        if (!std::isfinite(place.x) || !std::isfinite(place.y)) return std::nullopt;
        if (!line.empty() && !take(line, ' ')) return std::nullopt;
    }
    message.data = line;
    return message;
}

std::string line_from(int number, std::string_view data) {
    std::string line = std::to_string(number);
    line += ' ';
    line += data;
    line += '\r';
    return line;
}

}  // namespace puckloop::netmanager
