#include "protocols/radio/xbee_message.h"

#include <algorithm>
#include <optional>
#include <type_traits>

namespace puckloop::protocols {

namespace {

template <typename Message>
constexpr bool kIsOther = std::is_same_v<Message, XBeeOther>;

/// Appends members in the order in which they are visited.
struct Writer {
    XBeeBytes& bytes;

    void operator()(std::string_view, const auto& member) { put(member); }
    void put(const XBeeBytes& rest) { bytes.insert(bytes.end(), rest.begin(), rest.end()); }
    void put(const XBeeCommand& command) {
        for (const char c : command)
            bytes.push_back(static_cast<std::uint8_t>(c));
    }
    void put(std::unsigned_integral auto number) {
        for (int byte = sizeof number - 1; byte >= 0; --byte)
            bytes.push_back(static_cast<std::uint8_t>(std::uint64_t{number} >> 8 * byte));
    }
};

/// Takes members off the front; the bytes of the last list are all that is left.
struct Reader {
    std::span<const std::uint8_t> bytes;
    bool enough = true;

    void operator()(std::string_view, auto& member) { get(member); }
    std::uint8_t next() {
        if (bytes.empty()) {
            enough = false;
            return 0;
        }
        const std::uint8_t byte = bytes.front();
        bytes = bytes.subspan(1);
        return byte;
    }
    void get(XBeeBytes& rest) {
        rest.assign(bytes.begin(), bytes.end());
        bytes = {};
    }
    void get(XBeeCommand& command) {
        for (char& c : command)
            c = static_cast<char>(next());
    }
    template <std::unsigned_integral Number>
    void get(Number& number) {
        std::uint64_t value = 0;
        for (std::size_t i = 0; i < sizeof number; ++i)
            value = value << 8 | next();
        number = static_cast<Number>(value);
    }
};

template <typename Message>
std::optional<XBeeMessage> read_as(std::span<const std::uint8_t> data) {
    if constexpr (!kIsOther<Message>) {
        if (data.front() != Message::kType) return std::nullopt;
        Message message;
        Reader reader{data.subspan(1)};
        Message::fields(message, reader);
        if (reader.enough && reader.bytes.empty()) return message;
    }
    return std::nullopt;
}

template <typename... Messages>
XBeeMessage read_any(std::span<const std::uint8_t> data, std::variant<Messages...>*) {
    std::optional<XBeeMessage> found;
    ((found || (found = read_as<Messages>(data))), ...);
    if (found) return *found;
    return XBeeOther{data.front(), {data.begin() + 1, data.end()}};
}

}  // namespace

XBeeBytes encode(const XBeeMessage& message) {
    XBeeBytes bytes;
    std::visit(
        [&]<typename Message>(const Message& one) {
            if constexpr (!kIsOther<Message>) bytes.push_back(Message::kType);
            Message::fields(one, Writer{bytes});
        },
        message);
    return bytes;
}

XBeeMessage decode_xbee(std::span<const std::uint8_t> data) {
    if (data.empty()) return XBeeOther{};
    return read_any(data, static_cast<XBeeMessage*>(nullptr));
}

}  // namespace puckloop::protocols
