#include "run/factory/node_process.h"

#include "base/logs/log.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/processes/node_server.h"
#include "cosim/remote/protocol.h"
#include "emu/chip/translate/translation_switch.h"
#include "run/factory/node_factory.h"

#include <cstdlib>
#include <string_view>

namespace puckloop::tools {

namespace {

constexpr const char* kInterpret = "PUCKLOOP_INTERPRET";

}  // namespace

void interpret_from_here(bool in_nodes_too) {
    chip::set_translation(false);
    if (in_nodes_too) ::setenv(kInterpret, "1", 1);
}

std::optional<int> serve_as_node(int count, char** words) {
    const std::string_view title = count == 1 ? words[0] : "";
    if (!title.starts_with(cosim::kNodeTitle)) return std::nullopt;
    log::start_in_child(std::string(title.substr(cosim::kNodeTitle.size())));
    if (std::getenv(kInterpret) != nullptr) chip::set_translation(false);
    ::unsetenv(kInterpret);
    log::info("started for this node");
    const int status = cosim::serve_node(cosim::protocol::kDescriptor, make_described);
    log::info("ends with status {}", status);
    return status;
}

}  // namespace puckloop::tools
