// puckloop frames rab: the range-and-bearing board's infra-red frame as chips, 1 = carrier on.

#include "base/error.h"
#include "base/json.h"
#include "protocols/infrared/rab_errors.h"
#include "protocols/infrared/rab_frame.h"
#include "tools/cli/command.h"
#include "tools/records/frames.h"

#include <fmt/format.h>

#include <bit>
#include <iostream>
#include <limits>
#include <memory>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;
using namespace protocols;

constexpr std::string_view kMissedSwap = "a set and a clear payload bit flip: the number of ones stays";
constexpr std::string_view kMissedFollowed = "a payload bit and the check's lowest bit flip: the sum stays";

constexpr char kRow[] = "{:<20}{:>6}{:>10}{:>12}{:>8}{:>7}{:>8}\n";

struct RabArguments {
    std::string size;
    std::vector<std::string> inputs;  ///< payloads or chips
    bool json = false;
};

int size_of(const std::string& text, int when_absent) {
    if (text.empty()) return when_absent;
    const auto size = static_cast<int>(parse_number(text, 10, std::numeric_limits<int>::min(),
                                                    std::numeric_limits<int>::max(), "", "--size"));
    if (!is_rab_size(size))
        throw InputError("", "--size", fmt::format("{} bits cannot be sent", size), kRabSizesText);
    return size;
}

std::uint32_t payload_of(const std::string& text, int size, const std::string& origin) {
    const std::int64_t largest = (std::int64_t{1} << size) - 1;
    const std::string place = origin.empty() ? "--payload" : "payload";
    return static_cast<std::uint32_t>(parse_number(text, 16, 0, largest, origin, place));
}

std::string payload_text(std::uint32_t payload, int size) {
    return fmt::format("{:0{}X}", payload, size / 4);
}

/// The fields of a frame, under the names of the range-and-bearing fact sheet's vectors.
ordered_json fields_of(int size, std::uint32_t payload, int check) {
    return {{"size", size},
            {"payload", payload_text(payload, size)},
            {"ones", std::popcount(payload)},
            {"check", check}};
}

void encode_rab_frames(const RabArguments& arguments) {
    const int size = size_of(arguments.size, 16);
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const std::uint32_t payload = payload_of(text, size, origin);
        const std::string chips = encode_rab(size, payload);
        if (arguments.json) {
            ordered_json line = fields_of(size, payload, rab_check(payload));
            line["chips"] = chips;
            std::cout << line.dump() << '\n';
        } else {
            std::cout << chips << '\n';
        }
    });
}

std::string json_of(const RabFrameReading& reading) {
    ordered_json line = {{"ok", reading.ok()}};
    if (reading.ok() || reading.fault == RabFault::Check)
        line.update(fields_of(reading.size, reading.payload, reading.check));
    if (!reading.ok()) {
        line["fault"] = name_of(reading.fault);
        line["chip"] = reading.chip;
        line["problem"] = explain(reading);
    }
    return line.dump();
}

/// Answers for each frame; the status is 1 if any was bad.
void read_rab_frames(const RabArguments& arguments, int& status, bool fields) {
    const int size = size_of(arguments.size, 0);
    status = 0;
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const RabFrameReading reading = decode_rab(text, size, origin);
        if (!reading.ok()) status = 1;
        if (arguments.json)
            std::cout << json_of(reading) << '\n';
        else if (fields && reading.ok())
            std::cout << fmt::format("size {} payload {} ones {} check {:X}\n", reading.size,
                                     payload_text(reading.payload, reading.size),
                                     std::popcount(reading.payload), reading.check);
        else
            std::cout << (reading.ok() ? "" : "bad ") << explain(reading) << '\n';
    });
}

ordered_json json_of(const RabErrorCount& count) {
    return {{"all", count.all()},
            {"preamble", count.preamble},
            {"manchester", count.manchester},
            {"length", count.length},
            {"check", count.check},
            {"missed", count.missed()},
            {"missed_because", {{"swap", count.missed_swap}, {"check_follows", count.missed_followed}}}};
}

void classify(const RabArguments& arguments) {
    const int size = size_of(arguments.size, 16);
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const std::uint32_t payload = payload_of(text, size, origin);
        ordered_json line = fields_of(size, payload, rab_check(payload));
        std::string table = fmt::format("size {} payload {} ones {} check {:X}: {} chips\n", size,
                                        payload_text(payload, size), std::popcount(payload),
                                        rab_check(payload), rab_frame_chips(size));
        table += fmt::format(kRow, "errors", "all", "preamble", "manchester", "length", "check", "missed");
        for (const RabError error : kRabErrors) {
            const RabErrorCount count = count_rab_errors(error, size, payload);
            line["errors"][std::string(name_of(error))] = json_of(count);
            table += fmt::format(kRow, name_of(error), count.all(), count.preamble, count.manchester,
                                 count.length, count.check, count.missed());
            if (count.missed_swap)
                table += fmt::format("  missed {:>4}: {}\n", count.missed_swap, kMissedSwap);
            if (count.missed_followed)
                table += fmt::format("  missed {:>4}: {}\n", count.missed_followed, kMissedFollowed);
        }
        std::cout << (arguments.json ? line.dump() + "\n" : table);
    });
}

/// A subcommand with --size, --json and its input; `act` runs in its callback.
template <typename Act>
void declare_rab(Command& rab, const char* name, const char* help, bool takes_chips, Act act) {
    auto arguments = std::make_shared<RabArguments>();
    Command* command = rab.add_subcommand(name, help);
    command->add_option("--size", arguments->size,
                        takes_chips ? "payload bits: 8, 16, 24 or 32 (default: by the length)"
                                    : "payload bits: 8, 16, 24 or 32 (default 16)");
    command->add_option(takes_chips ? "CHIPS" : "--payload", arguments->inputs,
                        takes_chips ? "a frame as 0 and 1; without it, one a line on standard input"
                                    : "hexadecimal; without it, one a line on standard input");
    declare_action(*command, arguments->json, [arguments, act] { act(*arguments); });
}

}  // namespace

void declare_rab_frames(Command& frames, int& status) {
    Command* rab = frames.add_subcommand("rab", "Infra-red frames of the range-and-bearing board, as chips");
    rab->require_subcommand(1);
    declare_rab(*rab, "encode", "Print the chips of a payload, 1 = carrier on", false, encode_rab_frames);
    declare_rab(*rab, "decode",
                "Print size, payload and check of a frame, or what is wrong; status 1 if it is bad", true,
                [&status](const RabArguments& arguments) { read_rab_frames(arguments, status, true); });
    declare_rab(*rab, "check", "Say ok or what is wrong, chips counted from 0; status 1 if a frame is bad",
                true,
                [&status](const RabArguments& arguments) { read_rab_frames(arguments, status, false); });
    declare_rab(*rab, "errors",
                "Do every small error to a frame: what the reader finds, by what, and misses, why", false,
                classify);
}

}  // namespace puckloop::tools
