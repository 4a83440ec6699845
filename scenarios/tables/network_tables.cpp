#include "scenarios/tables/network_tables.h"

#include "base/error.h"
#include "emu/wifi/phy.h"
#include "protocols/network/ip_packet.h"
#include "scenarios/tables/linux_keys.h"
#include "scenarios/values/field_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>

namespace puckloop::scenarios {

using protocols::IpAddress;

namespace {

constexpr double kLongestLatency = 10.0, kShortestLatency = 1e-5;  // s
constexpr double kSlowest = 1e3, kFastest = 1e11;                  // bit/s
constexpr std::int64_t kLongestQueue = 1'000'000;                  // packets
constexpr std::string_view kExample = "such as \"10.0.0.0/24\"";

IpAddress mask_of(int prefix) {
    return ~IpAddress{0} << (32 - prefix);
}

/// "10.0.0.0/24".
void read_subnet(Reader& reader, NetworkMedium& medium) {
    const std::string text = reader.text("address", fmt::format("{}/{}", medium.address, medium.prefix));
    const std::size_t slash = text.find('/');
    const auto address = protocols::address_of(std::string_view(text).substr(0, slash));
    int prefix = 0;
    const char* const end = text.data() + text.size();
    const bool has_prefix = slash != std::string::npos &&
                            std::from_chars(text.data() + slash + 1, end, prefix).ptr == end &&
                            slash + 1 < text.size();
    if (!address || !has_prefix) reader.fail("address", fmt::format("'{}' is no network", text), kExample);
    if (prefix < 8 || prefix > 30)
        reader.fail("address", fmt::format("a network of {} bits", prefix), "/8 to /30");
    const IpAddress first = *address >> 24;
    if (first == 0 || first == 127 || first >= 224)
        reader.fail("address", fmt::format("'{}' is no network of computers", text), kExample);
    if ((*address & ~mask_of(prefix)) != 0)
        reader.fail("address", fmt::format("'{}' has bits beyond its prefix", text),
                    fmt::format("{}/{}", protocols::to_text(*address & mask_of(prefix)), prefix));
    medium.address = protocols::to_text(*address);
    medium.prefix = prefix;
}

double read_latency(Reader& reader, double fallback) {
    const double latency = reader.quantity("latency", Dimension::Time, fallback);
    if (!(latency >= kShortestLatency && latency <= kLongestLatency))
        reader.fail("latency", "latency is out of range", "10 us to 10 s");
    return latency;
}

std::array<double, 2> read_place(Reader& reader, std::string_view key) {
    const std::vector<double> place = reader.quantities(key, Dimension::Length, 2);
    return {place[0], place[1]};
}

/// mode = "wifi": its rates are those of [network.wifi].
void read_wifi(Reader& reader, NetworkMedium& medium) {
    wifi::WifiSettings& settings = medium.wifi.emplace();
    if (const TomlValue* table = reader.table("wifi")) {
        Reader keys(reader.file(), "network.wifi", *table);
        read_fields(keys, settings);
        if (const auto found = wifi::problem_of(settings))
            keys.fail(found->key, found->problem, found->expected);
    }
    if (reader.has("rate")) reader.fail("rate", "a radio has rates of its own", "rate in [network.wifi]");
    if (reader.has("access_point")) medium.access_point = read_place(reader, "access_point");
    if (settings.mesh && medium.access_point)
        reader.fail("access_point", "a mesh has no access point",
                    "mesh = false in [network.wifi], or no access point");
    medium.latency = read_latency(reader, 5e-4);
    medium.queue = reader.integer("queue", medium.queue, 1, kLongestQueue);
}

NetworkMedium read_medium(Reader& reader) {
    NetworkMedium medium;
    const std::string mode = reader.choice("mode", "perfect", {"perfect", "fixed", "wifi"});
    const bool perfect = mode == "perfect";
    read_subnet(reader, medium);
    if (mode == "wifi") {
        read_wifi(reader, medium);
        return medium;
    }
    for (const char* key : {"wifi", "access_point"})
        if (reader.has(key))
            reader.fail(key, fmt::format("a network that is not by radio has no {}", key), "mode = \"wifi\"");
    if (perfect) {
        for (const char* key : {"rate", "queue"})
            if (reader.has(key))
                reader.fail(key, fmt::format("a perfect network has no {}", key), "mode = \"fixed\"");
        medium.latency = read_latency(reader, medium.latency);
        return medium;
    }
    medium.latency = read_latency(reader, 1e-3);
    const std::string text = reader.text("rate", "11 Mbit/s");
    const auto rate = parse_rate(text);
    if (!rate) reader.fail("rate", fmt::format("'{}' is no rate", text), "such as \"11 Mbit/s\"");
    if (!(*rate >= kSlowest && *rate <= kFastest))
        reader.fail("rate", "rate is out of range", "1 kbit/s to 100 Gbit/s");
    medium.rate = *rate;
    medium.queue = reader.integer("queue", medium.queue, 1, kLongestQueue);
    return medium;
}

bool has_taken(const Scenario& scenario, const std::string& name) {
    const auto has = [&](const auto& list) {
        return std::any_of(list.begin(), list.end(), [&](const auto& one) { return one.name == name; });
    };
    constexpr std::array kFixed{"world",     "ir",          "ircom",   "ether",
                                "bluetooth", "coordinator", "network", "localhost"};
    return std::find(kFixed.begin(), kFixed.end(), name) != kFixed.end() || has(scenario.robots) ||
           has(scenario.tams) || has(scenario.can_buses) || has(scenario.hosts);
}

std::string read_host_name(Reader& reader, const Scenario& scenario) {
    constexpr std::size_t kLongest = 40;
    std::string name = reader.text("name", fmt::format("host{}", scenario.hosts.size()));
    const bool plain =
        !name.empty() && name.size() <= kLongest && std::all_of(name.begin(), name.end(), [](char c) {
            return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' ||
                   c == '_';
        });
    if (!plain)
        reader.fail("name", fmt::format("'{}' is no name of a host", name),
                    "1 to 40 letters, digits, '-' and '_'");
    if (has_taken(scenario, name))
        reader.fail("name", fmt::format("something else has the name '{}'", name), "another name");
    return name;
}

void read_host(const std::string& file, const TomlValue& table, Scenario& scenario) {
    Reader reader(file, fmt::format("host {}", scenario.hosts.size() + 1), table);
    if (!scenario.network) reader.fail("", "a host without a network", "[network], to which it belongs");
    ComputerHost host;
    host.name = host.board.hostname = read_host_name(reader, scenario);
    host.board.place_line = table.line;
    read_program(reader, host.board);
    host.board.address = read_network_address(reader);
    if (reader.has("position")) {
        if (!scenario.network->wifi)
            reader.fail("position", "a host without a radio is at no place", "mode = \"wifi\" in [network]");
        host.position = read_place(reader, "position");
    } else if (scenario.network->wifi && !scenario.network->access_point) {
        reader.fail("", fmt::format("{} has neither a radio nor a wire to an access point", host.name),
                    "position = [\"1 m\", \"0 m\"], or access_point in [network]");
    }
    if (host.board.command.empty())
        reader.fail("program", "'program' is missing", "program = [\"./server\"]");
    reader.finish();
    scenario.hosts.push_back(std::move(host));
}

/// The n-th address from the network's first or last one; nothing where there are not so many.
std::optional<std::string> free_address(const NetworkMedium& medium, std::size_t index, bool from_top) {
    const IpAddress network = protocols::address_of(medium.address).value_or(0);
    const IpAddress most = ~mask_of(medium.prefix) - 1;  // without network and broadcast
    if (index >= most) return std::nullopt;
    const auto place = static_cast<IpAddress>(index);
    return protocols::to_text(network | (from_top ? most - place : place + 1));
}

struct Addressed {
    std::string name;
    const LinuxBoard* board;
    std::size_t index;
    bool is_host;
};

std::vector<Addressed> addressed(const Scenario& scenario, bool all_robots) {
    std::vector<Addressed> list;
    for (std::size_t i = 0; i < scenario.robots.size(); ++i) {
        const auto& board = scenario.robots[i].linux_board;
        if (board || all_robots)
            list.push_back({scenario.robots[i].name, board ? &*board : nullptr, i, false});
    }
    for (std::size_t i = 0; i < scenario.hosts.size(); ++i)
        list.push_back({scenario.hosts[i].name, &scenario.hosts[i].board, i, true});
    return list;
}

std::string address_for(const Scenario& scenario, const Addressed& one) {
    if (one.board != nullptr && !one.board->address.empty()) return one.board->address;
    return free_address(*scenario.network, one.index, one.is_host).value_or("");
}

}  // namespace

void check_addresses(const Scenario& scenario) {
    const NetworkMedium& medium = *scenario.network;
    const IpAddress network = protocols::address_of(medium.address).value_or(0),
                    mask = mask_of(medium.prefix);
    std::map<IpAddress, std::string> owners;
    // A robot without a Linux board may get one on the command line.
    for (const Addressed& one : addressed(scenario, true)) {
        const std::string place = one.board == nullptr || one.board->place_line == 0
                                      ? one.name
                                      : fmt::format("line {}: {}", one.board->place_line, one.name);
        const std::string text = address_for(scenario, one);
        const auto refuse = [&](const std::string& what, const std::string& expected) {
            throw InputError(scenario.file.string(), place, what, expected);
        };
        if (text.empty())
            refuse(fmt::format("the network {}/{} has no address left", medium.address, medium.prefix),
                   "a larger one, such as \"10.0.0.0/16\"");
        const IpAddress address = protocols::address_of(text).value_or(0);
        if ((address & mask) != network || (address & ~mask) == 0 || (address | mask) == ~IpAddress{0})
            refuse(fmt::format("the address {} is none of a computer in {}/{}", text, medium.address,
                               medium.prefix),
                   free_address(medium, one.index, one.is_host).value_or(medium.address));
        const auto [owner, is_new] = owners.emplace(address, one.name);
        if (!is_new)
            refuse(fmt::format("{} has the address {} already", owner->second, text),
                   "an address of its own for each computer");
    }
}

std::string read_network_address(Reader& reader) {
    std::string address = reader.text("address", "");
    if (reader.has("address") && !protocols::address_of(address))
        reader.fail("address", fmt::format("'{}' is no address", address), "such as \"10.0.0.7\"");
    return address;
}

std::optional<double> parse_rate(std::string_view text) {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc()) return std::nullopt;
    std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
    while (unit.starts_with(' '))
        unit.remove_prefix(1);
    constexpr std::pair<std::string_view, double> kUnits[] = {
        {"bit/s", 1.0}, {"kbit/s", 1e3}, {"Mbit/s", 1e6}, {"Gbit/s", 1e9}};
    for (const auto& [name, factor] : kUnits)
        if (unit == name) return number * factor;
    return std::nullopt;
}

void read_network(Reader& top, Scenario& scenario) {
    if (const TomlValue* table = top.table("network")) {
        Reader reader(top.file(), "network", *table);
        scenario.network = read_medium(reader);
        reader.finish();
    }
    for (const TomlValue* table : top.tables("host"))
        read_host(top.file(), *table, scenario);
    if (scenario.network) return check_addresses(scenario);
    for (const RobotBoards& robot : scenario.robots)
        if (robot.linux_board && !robot.linux_board->address.empty())
            throw InputError(scenario.file.string(),
                             fmt::format("line {}: {}", robot.linux_board->place_line, robot.name),
                             "an address without a network", "[network]");
}

void name_computers(Scenario& scenario) {
    scenario.events.computers.clear();
    for (const NetworkComputer& one : computers_of(scenario))
        scenario.events.computers.push_back({one.name, protocols::address_of(one.address).value_or(0)});
}

std::vector<NetworkComputer> computers_of(const Scenario& scenario) {
    std::vector<NetworkComputer> computers;
    if (!scenario.network) return computers;
    for (const Addressed& one : addressed(scenario, false))
        computers.push_back({one.name, address_for(scenario, one), one.index, one.is_host});
    return computers;
}

}  // namespace puckloop::scenarios
