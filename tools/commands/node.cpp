// `puckloop node`: one node in a process of its own. Internal: the conductor starts it, with its end of a
// socket pair.

#include "cosim/node_server.h"
#include "cosim/protocol.h"
#include "tools/cli/command.h"
#include "tools/commands.h"
#include "tools/run/node_factory.h"

namespace puckloop::tools {

void declare_node(Command& app, int& status) {
    Command* command = app.add_subcommand("node", "(internal) serve one node of a run");
    command->group("");
    command->callback([&status] { status = cosim::serve_node(cosim::protocol::kDescriptor, make_node); });
}

}  // namespace puckloop::tools
