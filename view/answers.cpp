#include "view/answers.h"

#include "base/json.h"
#include "view/live/network_status.h"
#include "view/page_parts.h"
#include "view/recording/bytes.h"
#include "view/recording/camera_pictures.h"
#include "view/recording/serial_bytes.h"

#include <charconv>
#include <span>
#include <vector>

namespace puckloop::view {

namespace {

constexpr const char* kJson = "application/json; charset=utf-8";
constexpr const char* kBinary = "application/octet-stream";

std::optional<std::size_t> number_of(std::string_view text) {
    std::size_t value = 0;
    const char* const end = text.data() + text.size();
    const auto [at, error] = std::from_chars(text.data(), end, value);
    if (text.empty() || at != end || error != std::errc()) return std::nullopt;
    return value;
}

/// The value of the only parameter, which has to be called `name`.
std::optional<std::string_view> parameter(std::string_view query, std::string_view name) {
    if (query.size() <= name.size() || !query.starts_with(name) || query[name.size()] != '=' ||
        query.find('&') != std::string_view::npos)
        return std::nullopt;
    return query.substr(name.size() + 1);
}

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

}  // namespace

std::optional<std::string> unescaped(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '+') {
            out += ' ';
        } else if (text[i] != '%') {
            out += text[i];
        } else {
            const int high = i + 2 < text.size() ? hex_digit(text[i + 1]) : -1;
            const int low = i + 2 < text.size() ? hex_digit(text[i + 2]) : -1;
            if (high < 0 || low < 0) return std::nullopt;
            out += static_cast<char>(high * 16 + low);
            i += 2;
        }
    }
    return out;
}

std::optional<Content> Answers::texts(const EventReader& events, std::string_view query) {
    const auto list = parameter(query, "numbers");
    if (!list) return std::nullopt;
    std::vector<std::size_t> numbers;
    std::string_view rest = *list;
    while (true) {
        const std::size_t comma = rest.find(',');
        const auto number = number_of(rest.substr(0, comma));
        if (!number || numbers.size() >= kMostTexts) return std::nullopt;
        numbers.push_back(*number);
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    const nlohmann::json json = events.table().texts(numbers);
    return Content{kJson, json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

std::optional<Content> Answers::find(const EventReader& events, std::string_view query) {
    const auto text = parameter(query, "text");
    const auto part = text ? unescaped(*text) : std::nullopt;
    if (!part || part->empty() || part->size() > kLongestSearch) return std::nullopt;
    std::string out;
    append_numbers(out, std::span<const std::uint32_t>(events.table().find(*part, kMostFound)));
    return Content{kBinary, std::move(out)};
}

std::vector<std::string> Answers::robot_names() const {
    const auto& all = recording_.stations();
    return {all.begin(), all.begin() + static_cast<std::ptrdiff_t>(recording_.robots())};
}

/// "of=CAMERA,FRAME".
std::optional<Content> Answers::picture(std::string_view query) const {
    const auto both = parameter(query, "of");
    const std::size_t comma = both ? both->find(',') : std::string_view::npos;
    if (comma == std::string_view::npos) return std::nullopt;
    const auto camera = number_of(both->substr(0, comma)), frame = number_of(both->substr(comma + 1));
    if (!camera || !frame) return std::nullopt;
    auto bytes = camera_picture(recording_.folder(), robot_names(), *camera, *frame);
    if (!bytes) return std::nullopt;
    return Content{kBinary, std::move(*bytes)};
}

/// "from=OFFSET,LINK".
std::optional<Content> Answers::serial(std::string_view query) const {
    const auto both = parameter(query, "from");
    const std::size_t comma = both ? both->find(',') : std::string_view::npos;
    if (comma == std::string_view::npos) return std::nullopt;
    const auto from = number_of(both->substr(0, comma));
    const auto link = unescaped(both->substr(comma + 1));
    if (!from || !link || link->empty() || link->size() > kLongestSearch) return std::nullopt;
    return Content{kJson, serial_bytes(recording_.folder() / "trace.csv", *link, *from)};
}

std::optional<Content> Answers::get(std::string_view target) const {
    const std::size_t mark = target.find('?');
    const std::string_view name = target.substr(0, mark);
    const std::string_view query =
        mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
    const std::shared_ptr<const EventReader> latest = latest_();
    const EventReader& events = *latest;
    if (query.empty() && mark == std::string_view::npos) {
        if (name.empty()) return Content{"text/html; charset=utf-8", std::string(page_html())};
        if (name == "page.js") return Content{"text/javascript; charset=utf-8", std::string(page_script())};
        if (name == "page.css") return Content{"text/css; charset=utf-8", std::string(page_style())};
        if (name == "head") return Content{kJson, recording_.head()};
        if (name == "status") return Content{kJson, events.status()};
        if (name == "poses") return Content{kBinary, recording_.poses()};
        if (name == "trails") return Content{kBinary, recording_.trails()};
        if (name == "beams") return Content{kBinary, events.beams()};
        if (name == "cameras") return Content{kJson, camera_list(recording_.folder(), robot_names())};
        if (name == "drive" && driver_ != nullptr) return Content{kJson, driver_->state()};
        if (name == "possible" && driver_ != nullptr) return Content{kJson, driver_->possible()};
        return std::nullopt;
    }
    // The time is the page's own business.
    if (name.empty() && parameter(query, "t")) return get("");
    if (name == "texts") return texts(events, query);
    if (name == "serial") return serial(query);
    if (name == "picture") return picture(query);
    if (name == "network") {
        const auto at = parameter(query, "at");
        const auto milliseconds = at ? number_of(*at) : std::nullopt;
        if (!milliseconds) return std::nullopt;
        return Content{kJson, network_status(recording_.folder(), static_cast<double>(*milliseconds) / 1e3)};
    }
    if (name == "find") return find(events, query);
    const bool sensors = name == "sensors";
    const auto value = parameter(query, sensors ? "robot" : "from");
    const auto number = value ? number_of(*value) : std::nullopt;
    if (!number) return std::nullopt;
    if (sensors)
        return *number < recording_.robots() ? std::optional(Content{kBinary, recording_.sensors(*number)})
                                             : std::nullopt;
    if (name == "events") return Content{kBinary, events.table().block(*number, kMostEvents)};
    if (name == "tracked")
        return Content{"text/csv; charset=utf-8", recording_.tail(Recording::Rows::Tracker, *number)};
    if (name == "leds") return Content{kBinary, events.leds(*number, kMostEvents)};
    return std::nullopt;
}

}  // namespace puckloop::view
