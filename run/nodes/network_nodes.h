#pragma once
// The network of a run: its node, the hosts on it, and what Linux boards know of it.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <string>

namespace puckloop::tools {

/// Puts the program of `computer`, a robot or a host, on the scenario's network, if there is one.
void join_network(const RunSetup& setup, const std::string& computer, LinuxProgram& program);

/// The world states to the network where its robots are, or what stands between radios.
bool hears_world(const scenarios::Scenario& scenario);

/// The link for what events send to computers of the network. Behind all others
/// (LinkSpec::hashed_when_unused).
void add_messages(RunSetup& setup);

/// Network, hosts and links. After the robots. Throws InputError.
void add_network(RunSetup& setup, const RunRequest& request);

}  // namespace puckloop::tools
