#include "run/description/run_setup.h"

namespace puckloop::tools {

cosim::NodeSpec node_spec(const PlannedNode& node) {
    return {node.name, encode(node.what), node.in_process, node.any_thread, node.outside, node.host};
}

std::vector<cosim::NodeSpec> node_specs(const RunSetup& setup) {
    std::vector<cosim::NodeSpec> specs;
    for (const PlannedNode& node : setup.nodes)
        specs.push_back(node_spec(node));
    return specs;
}

}  // namespace puckloop::tools
