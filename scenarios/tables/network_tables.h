#pragma once
// The network between Linux boards and other computers: [network], [[host]].

#include "scenarios/description/scenario.h"
#include "scenarios/values/reader.h"

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::scenarios {

/// To be read when all robots have been.
void read_network(Reader& top, Scenario& scenario);

/// A computer of the network: its name and its address, as text.
struct NetworkComputer {
    std::string name;
    std::string address;
    std::size_t index = 0;  ///< among the scenario's robots, or its hosts
    bool is_host = false;
};
/// Robots that have a Linux board, and hosts, in their order. Without [network] none.
std::vector<NetworkComputer> computers_of(const Scenario& scenario);

/// For events that send something to one of them.
void name_computers(Scenario& scenario);

/// Every computer has an address of its own in the network, which there is. Throws InputError.
void check_addresses(const Scenario& scenario);

/// The key `address` of a computer, empty if it is absent.
std::string read_network_address(Reader& reader);

/// Bits a second of "11 Mbit/s"; nothing for what is no rate.
std::optional<double> parse_rate(std::string_view text);

}  // namespace puckloop::scenarios
