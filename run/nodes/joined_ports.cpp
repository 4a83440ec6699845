#include "run/nodes/joined_ports.h"

#include "base/error.h"
#include "protocols/network/ip_packet.h"
#include "run/control/control_place.h"
#include "scenarios/tables/network_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace puckloop::tools {

namespace {

constexpr const char* kOutsideHost = "outside";

struct JoinedPort {
    std::uint16_t port = 0;  ///< on 127.0.0.1
    std::string host;        ///< name or address in the network
    std::uint16_t to = 0;    ///< its port
};

[[noreturn]] void refuse_join(const std::string& what, const std::string& expected) {
    throw InputError("", "--join", what, expected);
}

std::optional<std::uint16_t> port_of(std::string_view text) {
    std::uint16_t port = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
    if (error != std::errc() || end != text.data() + text.size() || port == 0) return std::nullopt;
    return port;
}

JoinedPort parse_join(const std::string& text) {
    const std::size_t equals = text.find('='), colon = text.rfind(':');
    const auto refuse = [&] {
        refuse_join(fmt::format("'{}' is no way into the network", text),
                    "PORT=HOST:PORT, such as 8080=server:7000");
    };
    if (equals == std::string::npos || colon == std::string::npos || colon <= equals + 1) refuse();
    const auto port = port_of(std::string_view(text).substr(0, equals)),
               to = port_of(std::string_view(text).substr(colon + 1));
    if (!port || !to) refuse();
    return {*port, text.substr(equals + 1, colon - equals - 1), *to};
}

std::vector<JoinedPort> parse_joins(const RunRequest& request) {
    std::vector<JoinedPort> ports;
    for (const std::string& text : request.joins) {
        ports.push_back(parse_join(text));
        for (std::size_t i = 0; i + 1 < ports.size(); ++i)
            if (ports[i].port == ports.back().port)
                refuse_join(fmt::format("port {} is given twice", ports.back().port), "a port for each");
    }
    return ports;
}

void check_host(const std::string& host, const scenarios::Scenario& scenario) {
    if (protocols::address_of(host)) return;
    std::string known;
    for (const scenarios::NetworkComputer& one : scenarios::computers_of(scenario)) {
        if (one.name == host) return;
        known += (known.empty() ? "" : ", ") + one.name;
    }
    refuse_join(fmt::format("there is no '{}' on the network", host), "one of " + known + ", or an address");
}

}  // namespace

void add_outside_host(const RunRequest& request, scenarios::Scenario& scenario) {
    const std::vector<JoinedPort> ports = parse_joins(request);
    if (ports.empty()) return;
    if (!request.realtime && !request.paced)
        refuse_join("who joins from outside lives by the wall clock", "--paced or --realtime with it");
    if (!scenario.network) refuse_join("the scenario has no network", "[network] in it");
    if (scenario.network->wifi && !scenario.network->access_point)
        refuse_join("the network has no access point that the outside is wired to",
                    "access_point in [network]");
    const auto is_outside = [](const auto& one) { return one.name == kOutsideHost; };
    if (std::any_of(scenario.hosts.begin(), scenario.hosts.end(), is_outside) ||
        std::any_of(scenario.robots.begin(), scenario.robots.end(), is_outside))
        refuse_join(fmt::format("something in the scenario has the name '{}'", kOutsideHost),
                    "another name for it");
    for (const JoinedPort& port : ports)
        check_host(port.host, scenario);
    scenarios::ComputerHost host;
    host.name = host.board.hostname = kOutsideHost;
    host.board.command = {"puckloop-gate"};
    scenario.hosts.push_back(std::move(host));
    scenarios::check_addresses(scenario);
}

void plan_joined_ports(RunSetup& setup, const RunRequest& request) {
    const std::vector<JoinedPort> ports = parse_joins(request);
    if (ports.empty()) return;
    std::vector<std::string>& words = setup.scenario.hosts.back().board.command;
    for (const JoinedPort& port : ports) {
        const std::string socket = joined_socket_beside(setup.control, port.port);
        setup.joined.push_back({port.port, socket});
        words.push_back(fmt::format("{}={}:{}", socket, port.host, port.to));
        setup.warnings.push_back(
            fmt::format("127.0.0.1:{} leads to {}:{} of the network: the run cannot be repeated", port.port,
                        port.host, port.to));
    }
}

}  // namespace puckloop::tools
