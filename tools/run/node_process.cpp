#include "tools/run/node_process.h"

#include "base/log.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/node_server.h"
#include "cosim/remote/protocol.h"
#include "tools/run/node_factory.h"

#include <string_view>

namespace puckloop::tools {

std::optional<int> serve_as_node(int count, char** words) {
    const std::string_view title = count == 1 ? words[0] : "";
    if (!title.starts_with(cosim::kNodeTitle)) return std::nullopt;
    log::start_in_child(std::string(title.substr(cosim::kNodeTitle.size())));
    log::info("started for this node");
    const int status = cosim::serve_node(cosim::protocol::kDescriptor, make_node);
    log::info("ends with status {}", status);
    return status;
}

}  // namespace puckloop::tools
