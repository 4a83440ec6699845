#include "run/factory/preflight.h"

#include "base/error.h"
#include "linuxboard/shim/node/program_file.h"
#include "run/factory/node_factory.h"

#include <nlohmann/json.hpp>

#include <set>
#include <string>

namespace puckloop::tools {

namespace {

/// Names the board whose program it is: a swarm has many, and a scenario may give each another.
void check_program(const std::string& node, const std::string& program) {
    try {
        linuxboard::find_program(program);
    } catch (const InputError& error) {
        throw InputError("", node, error.what());
    }
}

}  // namespace

void check_files(const RunSetup& setup) {
    std::set<std::string> known;  // robots of a swarm differ in little else than their names
    for (const cosim::NodeSpec& node : setup.nodes) {
        auto spec = nlohmann::json::parse(node.json);
        spec.erase("log");  // this one leaves nothing on disk
        if (spec.at("kind") == "linux") check_program(node.name, spec.at("program"));
        if (spec.at("kind") != "pic" && spec.at("kind") != "rab" && spec.at("kind") != "tam") continue;
        auto what = spec;
        what.erase("name");
        what.erase("seed");
        if (known.insert(what.dump()).second) make_board(spec);
    }
}

}  // namespace puckloop::tools
