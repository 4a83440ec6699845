// `puckloop node`: one node in a process of its own. Internal: the conductor starts it, with its end of a
// socket pair.

#include "cosim/node_server.h"
#include "cosim/protocol.h"
#include "tools/commands.h"
#include "tools/run/node_factory.h"

#include <CLI/CLI.hpp>

namespace puckloop::tools {

void declare_node(CLI::App& app, int& status) {
    CLI::App* command = app.add_subcommand("node", "(internal) serve one node of a run");
    command->group("");
    command->callback([&status] { status = cosim::serve_node(cosim::protocol::kDescriptor, make_node); });
}

}  // namespace puckloop::tools
