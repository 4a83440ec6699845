#include "tools/run/preflight.h"

#include "linuxboard/shim/program_file.h"
#include "tools/run/node_factory.h"

#include <nlohmann/json.hpp>

#include <set>
#include <string>

namespace puckloop::tools {

void check_files(const RunSetup& setup) {
    std::set<std::string> known;  // robots of a swarm differ in little else than their names
    for (const cosim::NodeSpec& node : setup.nodes) {
        auto spec = nlohmann::json::parse(node.json);
        spec.erase("log");  // this one leaves nothing on disk
        if (spec.at("kind") == "linux") linuxboard::find_program(spec.at("program"));
        if (spec.at("kind") != "pic" && spec.at("kind") != "rab" && spec.at("kind") != "tam") continue;
        auto what = spec;
        what.erase("name");
        what.erase("seed");
        if (known.insert(what.dump()).second) make_board(spec);
    }
}

}  // namespace puckloop::tools
