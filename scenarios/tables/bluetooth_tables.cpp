#include "scenarios/tables/bluetooth_tables.h"

#include "base/error.h"
#include "emu/bluetooth/air_node.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace puckloop::scenarios {

namespace {

constexpr int kMostNumber = 9999;
constexpr double kLatestAction = 86'400.0 * 30;  // s, as a run

std::string read_word(Reader& reader, std::string_view key, const std::string& fallback, std::size_t most) {
    std::string text = reader.text(key, fallback);
    const bool printable = std::all_of(text.begin(), text.end(), [](char c) { return c >= ' ' && c <= '~'; });
    if (text.empty() || text.size() > most || !printable)
        reader.fail(key, fmt::format("'{}' is no {} of a Bluetooth module", text, key),
                    fmt::format("1 to {} printable characters", most));
    return text;
}

std::vector<double> read_spread(Reader& reader, std::string_view key, const std::vector<double>& fallback) {
    if (!reader.has(key)) return fallback;
    const auto spread = reader.quantities(key, Dimension::Time, 2);
    if (!(spread[0] >= 0.05 && spread[0] <= 600 && spread[1] >= 0 && spread[1] <= 600))
        reader.fail(key, fmt::format("{} is out of range", key),
                    "mean and standard deviation: [\"9.9 s\", \"4.3 s\"], the mean 0.05 s to 600 s");
    return spread;
}

}  // namespace

BluetoothModule read_bluetooth_module(const std::string& file, const std::string& where,
                                      const TomlValue& table, std::size_t index) {
    Reader reader(file, where, table);
    BluetoothModule module;
    const auto number = reader.integer("number", static_cast<std::int64_t>(index) + 1, 1, kMostNumber);
    module.name = read_word(reader, "name", fmt::format("e-puck_{:04}", number), bluetooth::kMostName - 1);
    module.pin = read_word(reader, "pin", fmt::format("{:04}", number), bluetooth::kMostPin);
    // National Semiconductor's block, as on e-pucks: the e-puck library looks for its first octet.
    module.address =
        reader.text("address", fmt::format("08:00:17:2C:{:02X}:{:02X}", number >> 8, number & 0xff));
    try {
        bluetooth::parse_address("", module.address);
    } catch (const InputError&) {
        reader.fail("address", fmt::format("'{}' is no Bluetooth address", module.address),
                    "six octets: \"08:00:17:2C:00:01\"");
    }
    module.automatic = reader.choice("mode", "automatic", {"automatic", "command"}) == "automatic";
    module.boot = reader.quantity("boot", Dimension::Time, module.boot);
    if (!(module.boot >= 0.001 && module.boot <= 10))
        reader.fail("boot", "boot is out of range", "1 ms to 10 s");
    module.computer = reader.text("computer", "");
    if (module.computer.empty() && reader.has("connect"))
        reader.fail("connect", "no computer links with this robot", "computer = \"pty\"");
    module.connect = reader.quantity("connect", Dimension::Time, module.connect);
    if (!(module.connect >= 0 && module.connect <= kLatestAction))
        reader.fail("connect", "connect is out of range", "0 s to 720 h");
    reader.finish();
    return module;
}

void read_bluetooth(Reader& top, Scenario& scenario) {
    std::set<std::string> addresses;
    for (const RobotBoards& robot : scenario.robots) {
        if (!robot.pic.bluetooth) continue;
        if (!addresses.insert(robot.pic.bluetooth->address).second)
            throw InputError(
                scenario.file.string(), robot.name + ".pic.bluetooth",
                fmt::format("another robot has the Bluetooth address {}", robot.pic.bluetooth->address),
                "a 'number' or 'address' of its own for each robot");
    }
    const TomlValue* table = top.table("bluetooth");
    if (table == nullptr) return;
    Reader reader(top.file(), "bluetooth", *table);
    BluetoothMedium& medium = scenario.bluetooth;
    medium.range = reader.quantity("range", Dimension::Length, medium.range);
    if (!(medium.range > 0 && medium.range <= 1e4))
        reader.fail("range", "range is out of range", "up to 10 km");
    medium.discovery = reader.quantity("discovery", Dimension::Time, medium.discovery);
    if (!(medium.discovery >= 0.01 && medium.discovery <= 3600))
        reader.fail("discovery", "discovery is out of range", "10 ms to 1 h");
    medium.name_time = read_spread(reader, "name_time", medium.name_time);
    medium.link_time = read_spread(reader, "link_time", medium.link_time);
    medium.release_time = read_spread(reader, "release_time", medium.release_time);
    reader.finish();
}

}  // namespace puckloop::scenarios
