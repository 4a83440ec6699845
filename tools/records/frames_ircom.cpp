// puckloop frames ircom: IRcom words as the times of a light's edges, in microseconds.

#include "base/error.h"
#include "base/json.h"
#include "protocols/infrared/ircom.h"
#include "tools/cli/command.h"
#include "tools/records/frames.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <iostream>
#include <memory>
#include <sstream>

namespace puckloop::tools {

namespace {

using nlohmann::ordered_json;
using namespace protocols;

constexpr double kMostMicroseconds = 1e9;
constexpr std::size_t kMostEdges = 1000;

struct IrcomArguments {
    std::string timing = "nominal";
    std::vector<std::string> inputs;
    bool json = false;
};

IrcomTiming timing_of(const std::string& text) {
    if (text == "nominal") return {};
    if (text == "epuck") return kIrcomEpuck;
    if (text == "tam") return kIrcomTam;
    throw InputError("", "--timing", fmt::format("{} is no sender", shown(text)), "nominal, epuck or tam");
}

double microseconds(cosim::Time time) {
    return static_cast<double>(time) / static_cast<double>(cosim::kMicrosecond);
}

void encode_ircom_words(const IrcomArguments& arguments) {
    const IrcomTiming timing = timing_of(arguments.timing);
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const auto word = static_cast<std::uint8_t>(
            parse_number(text, 16, 0, 0xFF, origin, origin.empty() ? "WORD" : "word"));
        const std::uint16_t symbols = ircom_symbols(word);
        std::string line;
        ordered_json times = ordered_json::array();
        for (const IrcomEdge& edge : ircom_edges(symbols, timing)) {
            line += fmt::format("{}{:.10g}", line.empty() ? "" : " ", microseconds(edge.time));
            times.push_back(microseconds(edge.time));
        }
        if (arguments.json)
            line = ordered_json{{"word", fmt::format("{:02X}", word)},
                                {"symbols", ircom_text(symbols)},
                                {"check", ircom_check(word)},
                                {"edges_us", std::move(times)}}
                       .dump();
        std::cout << line << '\n';
    });
}

/// Rising times in microseconds; the light goes on with the first.
std::vector<IrcomEdge> edges_of(const std::string& text, const std::string& origin) {
    std::vector<IrcomEdge> edges;
    std::istringstream stream(text);
    for (std::string part; stream >> part;) {
        const std::string place = fmt::format("edge {}", edges.size());
        double time = 0.0;
        const auto [stop, error] = std::from_chars(part.data(), part.data() + part.size(), time);
        if (error != std::errc{} || stop != part.data() + part.size() ||
            !(std::abs(time) <= kMostMicroseconds))
            throw InputError(origin, place, fmt::format("{} is no time", shown(part)),
                             "microseconds, at most 1e9");
        const auto at = std::llround(time * static_cast<double>(cosim::kMicrosecond));
        if (!edges.empty() && at <= edges.back().time)
            throw InputError(origin, place, fmt::format("{} is not after the edge before", shown(part)),
                             "rising times");
        if (edges.size() == kMostEdges)
            throw InputError(origin, place, "too many edges", fmt::format("at most {}", kMostEdges));
        edges.push_back({at, edges.size() % 2 == 0});
    }
    if (edges.empty()) throw InputError(origin, "edges", "there are none", "rising times in microseconds");
    return edges;
}

std::string json_of(const IrcomReading& reading) {
    ordered_json line{{"ok", reading.ok()}};
    if (reading.ok() || reading.fault == IrcomFault::Check) {
        line["word"] = fmt::format("{:02X}", reading.word);
        line["symbols"] = ircom_text(reading.symbols);
        line["check"] = reading.check;
    }
    line["start_us"] = microseconds(reading.start);
    line["end_us"] = microseconds(reading.end);
    if (!reading.ok()) {
        line["fault"] = name_of(reading.fault);
        line["edge"] = reading.edge;
        line["problem"] = explain(reading);
    }
    return line.dump();
}

/// Answers for each word; the status is 1 if any was bad.
void read_ircom_edges(const IrcomArguments& arguments, int& status, bool fields) {
    status = 0;
    for_each_input(arguments.inputs, [&](const std::string& text, const std::string& origin) {
        const IrcomReading reading = read_ircom(edges_of(text, origin));
        if (!reading.ok()) status = 1;
        if (arguments.json)
            std::cout << json_of(reading) << '\n';
        else if (reading.ok() && !fields)
            std::cout << "ok\n";
        else
            std::cout << (reading.ok() ? "" : "bad ") << explain(reading) << '\n';
    });
}

template <typename Act>
void declare_ircom(Command& ircom, const char* name, const char* help, bool takes_edges, Act act) {
    auto arguments = std::make_shared<IrcomArguments>();
    Command* command = ircom.add_subcommand(name, help);
    if (!takes_edges)
        command->add_option("--timing", arguments->timing,
                            "half periods: nominal (260/520 us), epuck (261/521.4) or tam (268/528)");
    command->add_option(takes_edges ? "TIMES" : "WORD", arguments->inputs,
                        takes_edges ? "a word's edges in microseconds, the first one a rise; without it, one "
                                      "word a line on standard input"
                                    : "hexadecimal byte; without it, one a line on standard input");
    declare_action(*command, arguments->json, [arguments, act] { act(*arguments); });
}

}  // namespace

void declare_ircom_frames(Command& frames, int& status) {
    Command* ircom = frames.add_subcommand("ircom", "Infra-red words of e-puck and TAM, as edges of light");
    ircom->require_subcommand(1);
    declare_ircom(*ircom, "encode", "Print the edges of a word in microseconds, the first at 0", false,
                  encode_ircom_words);
    declare_ircom(*ircom, "decode",
                  "Print the word of a line of edges, or what is wrong; status 1 if it is bad", true,
                  [&status](const IrcomArguments& arguments) { read_ircom_edges(arguments, status, true); });
    declare_ircom(*ircom, "check",
                  "Print ok or what is wrong, edges counted from 0; status 1 if a word is bad", true,
                  [&status](const IrcomArguments& arguments) { read_ircom_edges(arguments, status, false); });
}

}  // namespace puckloop::tools
