#include "scenarios/fault_tables.h"

#include "scenarios/reader.h"

#include <fmt/format.h>

#include <charconv>
#include <vector>

namespace puckloop::scenarios {

namespace {

/// A link that faults can sit on.
struct FaultLink {
    std::string name;
    std::string a, b;  ///< nodes at its ends
    bool is_radio = false;
};

/// The UART links between boards, and those between radio modules and the air.
std::vector<FaultLink> fault_links(const Scenario& scenario) {
    std::vector<FaultLink> links;
    for (const RobotBoards& robot : scenario.robots)
        if (robot.linux_board)
            links.push_back({robot.name + ".uart", robot.name + ".linux", robot.name + ".pic"});
    for (const TamBoard& tam : scenario.tams) {
        if (!tam.xbee.fitted) continue;
        links.push_back({tam.name + ".xbee", tam.name + ".avr", tam.name + ".xbee"});
        links.push_back({tam.name + ".radio", tam.name + ".xbee", "ether", true});
    }
    if (scenario.coordinator) {
        if (!scenario.coordinator->uart.empty())
            links.push_back({"coordinator.uart", "coordinator.uart", "coordinator.xbee"});
        if (scenario.coordinator->program)
            links.push_back({"coordinator.uart", "coordinator.linux", "coordinator.xbee"});
        links.push_back({"coordinator.radio", "coordinator.xbee", "ether", true});
    }
    return links;
}

FaultLink find_link(Reader& reader, const std::string& name, const Scenario& scenario) {
    std::string known;
    for (const FaultLink& link : fault_links(scenario)) {
        if (link.name == name) return link;
        known += (known.empty() ? "" : ", ") + link.name;
    }
    reader.fail("link", fmt::format("there is no UART link '{}'", name),
                known.empty() ? "a robot with a [robot.linux] program" : known);
}

/// bytes = ["0x00", "0xFF"].
std::vector<std::uint8_t> read_bytes(Reader& reader) {
    std::vector<std::uint8_t> bytes;
    for (const std::string& text : reader.texts("bytes")) {
        const bool hexadecimal = text.starts_with("0x") || text.starts_with("0X");
        const char* const first = text.data() + (hexadecimal ? 2 : 0);
        const char* const last = text.data() + text.size();
        std::uint8_t value = 0;
        const auto [end, error] = std::from_chars(first, last, value, hexadecimal ? 16 : 10);
        if (error != std::errc() || end != last)
            reader.fail("bytes", fmt::format("'{}' is not a byte", text), "such as \"0x7F\" or \"127\"");
        bytes.push_back(value);
    }
    if (bytes.empty())
        reader.fail("bytes", "bytes is empty", "such as [\"0x00\", \"0xFF\"], or no 'bytes' for all");
    return bytes;
}

}  // namespace

cosim::FaultSpec read_fault(const std::string& file, std::size_t index, const TomlValue& table,
                            const Scenario& scenario) {
    Reader reader(file, fmt::format("fault {}", index + 1), table);
    cosim::FaultSpec fault;
    fault.link = reader.text("link");
    fault.from = reader.text("from", "");
    const std::vector<std::string> kinds{"drop",       "flip",  "delay", "duplicate",
                                         "disconnect", "stuck", "rate",  "cut"};
    fault.kind = *cosim::fault_of_name(reader.choice("kind", "drop", kinds));
    fault.probability = reader.quantity("probability", Dimension::Ratio, 1.0);
    if (!(fault.probability >= 0 && fault.probability <= 1))
        reader.fail("probability", "probability is out of range", "0 to 1, or \"5 %\"");
    if (reader.has("count"))
        fault.count = static_cast<std::uint64_t>(reader.integer("count", 1, 1, 1'000'000'000));
    fault.begin = cosim::from_seconds(reader.quantity("begin", Dimension::Time, 0.0));
    if (const auto end = reader.optional_quantity("end", Dimension::Time))
        fault.end = cosim::from_seconds(*end);
    if (fault.begin < 0 || fault.end <= fault.begin)
        reader.fail("begin", "the fault's window is empty", "0 s <= begin < end");
    if (fault.kind == cosim::FaultKind::Delay) fault.amount = reader.quantity("delay", Dimension::Time);
    if (fault.kind == cosim::FaultKind::Rate) fault.amount = reader.quantity("factor", Dimension::Ratio);
    if (fault.kind == cosim::FaultKind::Cut) {
        fault.again = reader.quantity("again", Dimension::Ratio, 0.0);
        if (!(fault.again >= 0 && fault.again <= 1))
            reader.fail("again", "again is out of range", "0 to 1, or \"30 %\"");
    } else if (reader.has("bytes")) {
        fault.bytes = read_bytes(reader);
    }
    reader.finish();
    const FaultLink link = find_link(reader, fault.link, scenario);
    if (!fault.from.empty() && fault.from != link.a && fault.from != link.b)
        reader.fail("from", fmt::format("'{}' is at no end of {}", fault.from, fault.link),
                    fmt::format("{} or {}", link.a, link.b));
    if (link.is_radio && !cosim::harms_radio(fault.kind))
        reader.fail("kind", fmt::format("a radio link cannot suffer {}", cosim::fault_name(fault.kind)),
                    "drop, flip, delay, duplicate or disconnect");
    if (link.is_radio && !fault.bytes.empty())
        reader.fail("bytes", "frames on air are no single bytes", "no 'bytes' for a radio link");
    return fault;
}

}  // namespace puckloop::scenarios
