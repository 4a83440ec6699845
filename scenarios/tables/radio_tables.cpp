#include "scenarios/tables/radio_tables.h"

#include "emu/xbee/at_table.h"

#include "protocols/radio/xbee_message.h"
#include "scenarios/tables/linux_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::scenarios {

namespace {

// Digi's block of addresses; the lower half distinguishes modules.
constexpr std::uint64_t kDigi = 0x0013A20000000000, kCoordinatorLow = 0x40000000;
constexpr std::int64_t kFirstNetwork = 0x01B2;  // TAM fact sheet, section 6
constexpr int kNetworks = 4;
constexpr std::uint32_t kEuropeanCca = 0x3A;          // -58 dBm: Digi's manual, CA, "ETSI compliance"
constexpr double kLongestDelay = 1.0;                 // s
constexpr std::string_view kCoordinatorId = "COORD";  // TAM fact sheet: whom a TAM asks for

std::uint64_t read_address(Reader& reader, std::uint64_t fallback) {
    if (!reader.has("address")) return fallback;
    const std::string text = reader.text("address");
    std::uint64_t address = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), address, 16);
    constexpr std::size_t kDigits = 16;
    if (error != std::errc() || end != text.data() + text.size() || text.size() != kDigits)
        reader.fail("address", fmt::format("'{}' is no address", text),
                    "16 hex digits: \"0013A20040000001\"");
    // Both mean something else as a destination: frames for them never reach a module that has them.
    if (address == protocols::kXBeeBroadcast || address == 0)
        reader.fail("address", fmt::format("'{}' is no module's own address", text),
                    "neither 0 nor FFFF, which is for all");
    return address;
}

/// Any AT parameters by name: parameters = { RR = 3, MT = 0 }.
void read_module_parameters(Reader& reader, XBeeModule& module) {
    const TomlValue* table = reader.table("parameters");
    if (table == nullptr) return;
    Reader parameters(reader.file(), "parameters", *table);
    for (const auto& [command, value] : parameters.everything()) {
        (void)value;
        const auto place = xbee::find_parameter(command);
        if (!place || xbee::at_table()[*place].read_only)
            parameters.fail(command, fmt::format("the module has no AT parameter '{}' to set", command),
                            "RR, MT, CA, PL, NT, ...");
        const xbee::AtParameter& parameter = xbee::at_table()[*place];
        const auto number = static_cast<std::uint32_t>(
            parameters.integer(command, parameter.factory, parameter.least, parameter.most));
        if (!xbee::accepts(parameter, number))
            parameters.fail(command, fmt::format("{} has no value {}", command, number),
                            "0 to 7 for 1200 to 115200 baud, or a rate from 128 on");
        module.parameters[command] = number;
    }
}

void read_module(Reader& reader, XBeeModule& module) {
    module.address = read_address(reader, module.address);
    module.node_id = reader.text("node_id", module.node_id);
    const bool printable = std::all_of(module.node_id.begin(), module.node_id.end(),
                                       [](char c) { return c >= ' ' && c <= '~'; });
    if (module.node_id.empty() || module.node_id.size() > xbee::kMostNodeIdentifier || !printable)
        reader.fail("node_id", fmt::format("'{}' is no node identifier", module.node_id),
                    "1 to 20 printable characters");
    module.parameters["CH"] = static_cast<std::uint32_t>(reader.integer("channel", 12, 11, 26));
    module.boot = reader.quantity("boot", Dimension::Time, module.boot);
    if (!(module.boot >= 0 && module.boot <= 10)) reader.fail("boot", "boot is out of range", "0 s to 10 s");
    read_module_parameters(reader, module);
}

/// The computer with the coordinator's program; its files go to a folder of their own.
void read_computer(Reader& reader, CoordinatorPlace& place, int line) {
    if (!place.uart.empty())
        reader.fail("uart", "the module has one serial line, and the program is at it",
                    "either 'program' or 'uart'");
    LinuxBoard& board = place.program.emplace();
    board.hostname = board.folder = "coordinator";
    board.grace = 12.0;  // the program gives LEDs 10 s to go off, and then writes its files
    board.place_line = line;
    read_program(reader, board);
    place.tty = reader.text("tty", place.tty);
    if (!place.tty.starts_with("/dev/"))
        reader.fail("tty", fmt::format("'{}' is no serial port", place.tty), "such as \"/dev/ttyUSB0\"");
}

}  // namespace

XBeeModule read_tam_module(const std::string& file, const std::string& tam, const TomlValue* table,
                           std::size_t index, int network) {
    XBeeModule module;
    module.address = kDigi | (kCoordinatorLow + 1 + index);
    module.node_id = fmt::format("TAM{:02}", index);
    module.parameters["ID"] = static_cast<std::uint32_t>(kFirstNetwork + network);
    module.parameters["CA"] = kEuropeanCca;
    if (table == nullptr) return module;
    Reader reader(file, tam + ".xbee", *table);
    module.fitted = reader.flag("fitted", true);
    if (!module.fitted && reader.everything().size() > 1)
        reader.fail("fitted", "a module that is not fitted has no other keys", "'fitted = false' alone");
    read_module(reader, module);
    if (module.node_id == kCoordinatorId)
        reader.fail("node_id",
                    fmt::format("'{}' is the coordinator's: TAMs would report to each other", module.node_id),
                    "another one, such as \"TAM07\"");
    reader.finish();
    return module;
}

RadioMedium read_radio(Reader& top) {
    RadioMedium medium;
    const TomlValue* table = top.table("radio");
    if (table == nullptr) return medium;
    Reader reader(top.file(), "radio", *table);
    medium.range = reader.quantity("range", Dimension::Length, medium.range);
    if (!(medium.range > 0 && medium.range <= 1e4))
        reader.fail("range", "range is out of range", "up to 10 km");
    medium.exponent = reader.quantity("exponent", Dimension::Number, medium.exponent);
    if (!(medium.exponent >= 1 && medium.exponent <= 10))
        reader.fail("exponent", "exponent is out of range", "1 to 10; 2 in free space");
    medium.loss = reader.quantity("loss", Dimension::Ratio, medium.loss);
    if (!(medium.loss >= 0 && medium.loss <= 1))
        reader.fail("loss", "loss is out of range", "0 to 1, or \"5 %\"");
    medium.processing = reader.quantity("processing", Dimension::Time, medium.processing);
    if (!(medium.processing >= 1e-5 && medium.processing <= kLongestDelay))
        reader.fail("processing", "processing is out of range", "0.01 ms to 1 s");
    reader.finish();
    return medium;
}

std::optional<CoordinatorPlace> read_coordinator(Reader& top) {
    const TomlValue* table = top.table("coordinator");
    if (table == nullptr) return std::nullopt;
    Reader reader(top.file(), "coordinator", *table);
    CoordinatorPlace place;
    place.module.address = kDigi | kCoordinatorLow;
    place.module.node_id = kCoordinatorId;
    const auto network = reader.integer("network", kNetworks - 1, 0, kNetworks - 1);
    place.module.parameters["ID"] = static_cast<std::uint32_t>(kFirstNetwork + network);
    place.module.parameters["CA"] = kEuropeanCca;
    if (reader.has("position")) {
        const auto position = reader.quantities("position", Dimension::Length, 2);
        place.x = position[0];
        place.y = position[1];
    }
    place.uart = reader.text("uart", "");
    if (reader.has("program")) read_computer(reader, place, table->line);
    place.baud = reader.quantity("baud", Dimension::Number, place.baud);
    if (!(place.baud >= 1200 && place.baud <= 250'000))
        reader.fail("baud", "baud is out of range", "1200 to 250000");
    read_module(reader, place.module);
    reader.finish();
    return place;
}

}  // namespace puckloop::scenarios
