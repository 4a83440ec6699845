#include "tools/run/preflight.h"

#include "linuxboard/shim/program_file.h"
#include "tools/run/node_factory.h"

#include <nlohmann/json.hpp>

namespace puckloop::tools {

void check_files(const RunSetup& setup) {
    for (const cosim::NodeSpec& node : setup.nodes) {
        auto spec = nlohmann::json::parse(node.json);
        spec.erase("log");  // this one leaves nothing on disk
        if (spec.at("kind") == "pic" || spec.at("kind") == "rab") make_board(spec);
        if (spec.at("kind") == "linux") linuxboard::find_program(spec.at("program"));
    }
}

}  // namespace puckloop::tools
