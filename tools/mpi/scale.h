#pragma once
// `puckloop-mpi scale`: what more machines would gain.

#include "cosim/remote/mpi/mpi_hosts.h"
#include "tools/cli/command.h"

namespace puckloop::tools {

void declare_scale(Command& app, int& status, cosim::MpiHosts& hosts);

}  // namespace puckloop::tools
