// puckloop frames xbee: API frames of XBee modules, as hexadecimal bytes of the serial line.

#include "base/error.h"
#include "base/json.h"
#include "protocols/radio/xbee_frame.h"
#include "protocols/radio/xbee_message.h"
#include "tools/cli/command.h"
#include "tools/records/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;
using namespace protocols;

constexpr std::size_t kMostData = 65535;

struct XbeeArguments {
    std::string mode = "2";
    std::vector<std::string> inputs;
    bool json = false;
};

XBeeApiMode mode_of(const std::string& text) {
    if (text == "1") return XBeeApiMode::Plain;
    if (text == "2") return XBeeApiMode::Escaped;
    throw InputError("", "--mode", fmt::format("{} is no API mode", shown(text)),
                     "1 (plain) or 2 (escaped), as the module's AP");
}

std::string hex(std::span<const std::uint8_t> bytes, std::string_view between) {
    std::string text;
    for (const std::uint8_t byte : bytes)
        text += fmt::format("{}{:02X}", text.empty() ? "" : between, byte);
    return text;
}

// --- members as text ---------------------------------------------------------------------------------------

bool is_printable(const XBeeCommand& command) {
    return std::all_of(command.begin(), command.end(), [](char c) { return c > ' ' && c <= '~'; });
}

/// A command that is no text is printed as four digits.
std::string text_of(const XBeeCommand& command) {
    if (is_printable(command)) return {command.begin(), command.end()};
    return fmt::format("{:02X}{:02X}", static_cast<std::uint8_t>(command[0]),
                       static_cast<std::uint8_t>(command[1]));
}
std::string text_of(const XBeeBytes& bytes) {
    return bytes.empty() ? "-" : hex(bytes, "");
}
std::string text_of(std::unsigned_integral auto number) {
    return fmt::format("{:0{}X}", number, 2 * sizeof number);
}

struct Place {
    const std::string& origin;
    std::string_view name;
};

void parse(XBeeCommand& command, const std::string& text, const Place& at) {
    if (text.size() == 4) {
        const auto number = parse_number(text, 16, 0, 0xFFFF, at.origin, at.name);
        command = {static_cast<char>(number >> 8), static_cast<char>(number)};
        return;
    }
    if (text.size() != 2)
        throw InputError(at.origin, at.name, fmt::format("{} is no command", shown(text)),
                         "two characters, or four hexadecimal digits");
    command = {text[0], text[1]};
}
void parse(XBeeBytes& bytes, const std::string& text, const Place& at) {
    if (text != "-") bytes = bytes_of(text, at.origin);
}
template <std::unsigned_integral Number>
void parse(Number& number, const std::string& text, const Place& at) {
    if constexpr (sizeof number == sizeof(std::uint64_t)) {
        constexpr std::size_t kHalf = 8;
        std::string digits = text.starts_with("0x") || text.starts_with("0X") ? text.substr(2) : text;
        if (digits.size() > 2 * kHalf)
            throw InputError(at.origin, at.name, fmt::format("{} is too long", shown(text)),
                             "at most 16 hexadecimal digits");
        const std::size_t low = digits.size() > kHalf ? digits.size() - kHalf : 0;
        const auto part = [&](const std::string& some) {
            return static_cast<std::uint64_t>(
                parse_number(some, 16, 0, std::numeric_limits<std::uint32_t>::max(), at.origin, at.name));
        };
        number = (low ? part(digits.substr(0, low)) << 32 : 0) | part(digits.substr(low));
    } else {
        number = static_cast<Number>(
            parse_number(text, 16, 0, std::numeric_limits<Number>::max(), at.origin, at.name));
    }
}

// --- messages as text --------------------------------------------------------------------------------------

std::string text_of(const XBeeMessage& message) {
    std::string text;
    std::visit(
        [&]<typename Message>(const Message& one) {
            text = Message::kName;
            Message::fields(one, [&](std::string_view name, const auto& member) {
                text += fmt::format(" {} {}", name, text_of(member));
            });
        },
        message);
    return text;
}

ordered_json json_of(const XBeeMessage& message) {
    ordered_json line;
    std::visit(
        [&]<typename Message>(const Message& one) {
            line["message"] = Message::kName;
            Message::fields(one, [&](std::string_view name, const auto& member) {
                const std::string text = text_of(member);
                line[std::string(name)] = text == "-" ? "" : text;
            });
        },
        message);
    return line;
}

std::vector<std::string> words_of(const std::string& text) {
    std::vector<std::string> words;
    std::istringstream stream(text);
    for (std::string word; stream >> word;)
        words.push_back(word);
    return words;
}

/// Sets the members that the words name; the others keep their defaults.
template <typename Message>
Message fill(const std::vector<std::string>& words, const std::string& origin) {
    Message message;
    for (std::size_t w = 1; w < words.size(); w += 2) {
        bool known = false;
        std::string names;
        Message::fields(message, [&](std::string_view name, auto& member) {
            names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
            if (words[w] != name) return;
            known = true;
            if (w + 1 == words.size())
                throw InputError(origin, words[w], "has no value", "a value, - for no bytes");
            parse(member, words[w + 1], {origin, name});
        });
        if (!known)
            throw InputError(origin, fmt::format("word {}", w + 1),
                             fmt::format("{} has no field {}", Message::kName, shown(words[w])), names);
    }
    return message;
}

template <typename... Messages>
XBeeMessage message_of(const std::string& text, const std::string& origin, std::variant<Messages...>*) {
    const std::vector<std::string> words = words_of(text);
    std::optional<XBeeMessage> message;
    std::string names;
    const auto consider = [&]<typename Message>(Message*) {
        names += fmt::format("{}{}", names.empty() ? "" : ", ", Message::kName);
        if (!words.empty() && words[0] == Message::kName) message = fill<Message>(words, origin);
    };
    (consider(static_cast<Messages*>(nullptr)), ...);
    if (!message)
        throw InputError(origin, "message", fmt::format("{} is none", shown(words.empty() ? "" : words[0])),
                         names);
    return *message;
}

// --- commands ----------------------------------------------------------------------------------------------

void encode_all(const XbeeArguments& arguments) {
    const XBeeApiMode mode = mode_of(arguments.mode);
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const XBeeBytes data = encode(message_of(text, origin, static_cast<XBeeMessage*>(nullptr)));
        if (data.size() > kMostData)
            throw InputError(origin, "message", fmt::format("{} bytes do not fit a frame", data.size()),
                             "at most 65535");
        const XBeeBytes bytes = encode_xbee(data, mode);
        if (arguments.json)
            std::cout << ordered_json{{"bytes", hex(bytes, " ")}}.dump() << '\n';
        else
            std::cout << hex(bytes, " ") << '\n';
    });
}

void print(const XBeeReading& reading, const XbeeArguments& arguments, bool fields) {
    if (arguments.json) {
        ordered_json line = {{"ok", reading.ok()}};
        if (reading.ok() && fields) line.update(json_of(decode_xbee(reading.data)));
        if (!reading.ok()) {
            line["fault"] = name_of(reading.fault);
            line["byte"] = reading.at;
            line["problem"] = explain(reading);
        }
        std::cout << line.dump() << '\n';
    } else if (reading.ok() && fields) {
        std::cout << text_of(decode_xbee(reading.data)) << '\n';
    } else {
        std::cout << (reading.ok() ? "" : "bad ") << explain(reading) << '\n';
    }
}

/// Each input is a stretch of the line: any number of frames. The status is 1 if anything in it was bad.
void read_xbee(const XbeeArguments& arguments, int& status, bool fields) {
    const XBeeApiMode mode = mode_of(arguments.mode);
    status = 0;
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        XBeeReader reader(mode, kMostData);
        const auto take = [&](const std::optional<XBeeReading>& reading) {
            if (!reading) return;
            if (!reading->ok()) status = 1;
            print(*reading, arguments, fields);
        };
        const XBeeBytes bytes = bytes_of(text, origin);
        if (bytes.empty()) throw InputError(origin, "frame", "holds no byte", "hexadecimal bytes");
        for (const std::uint8_t byte : bytes)
            take(reader.take(byte));
        take(reader.end());
    });
}

template <typename Act>
void declare_xbee(Command& xbee, const char* name, const char* help, const char* input,
                  const char* input_help, Act act) {
    auto arguments = std::make_shared<XbeeArguments>();
    Command* command = xbee.add_subcommand(name, help);
    command->add_option("--mode", arguments->mode, "API mode: 1 plain, 2 escaped (default 2)");
    command->add_option(input, arguments->inputs, input_help);
    declare_action(*command, arguments->json, [arguments, act] { act(*arguments); });
}

}  // namespace

void declare_xbee_frames(Command& frames, int& status) {
    Command* xbee = frames.add_subcommand("xbee", "API frames of XBee modules, as bytes of the serial line");
    xbee->require_subcommand(1);
    declare_xbee(
        *xbee, "encode", "Print the bytes of a message", "MESSAGE",
        "as decode prints it, in one argument: \"at id 1 command NT value 3C\"; fields that are left out "
        "have their usual value; without it, one a line on standard input",
        encode_all);
    constexpr char kBytes[] =
        "hexadecimal, a stretch of the line in one argument; without it, one a line on standard input";
    declare_xbee(*xbee, "decode", "Print the messages, or what is wrong; status 1 if a frame is bad", "BYTES",
                 kBytes, [&status](const XbeeArguments& arguments) { read_xbee(arguments, status, true); });
    declare_xbee(*xbee, "check",
                 "Print ok or what is wrong, bytes counted from 0; status 1 if a frame is bad", "BYTES",
                 kBytes, [&status](const XbeeArguments& arguments) { read_xbee(arguments, status, false); });
}

}  // namespace puckloop::tools
