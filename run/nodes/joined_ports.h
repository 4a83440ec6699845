#pragma once
// --join PORT=HOST:PORT: programs of this machine join a run's network at ports on loopback. In the network
// they are the host "outside", whose program connects for them (linuxboard/gate).

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

namespace puckloop::tools {

/// Adds the host "outside", if any port is joined. Throws InputError for what is no join, for a run that is
/// not paced by the wall clock, one without a network or whose network nobody can be wired to, a port that is
/// named twice, a host that is not there.
void add_outside_host(const RunRequest& request, scenarios::Scenario& scenario);

/// Its sockets, in the private folder of `setup.control`, and its program's arguments.
void plan_joined_ports(RunSetup& setup, const RunRequest& request);

}  // namespace puckloop::tools
