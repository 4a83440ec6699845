#pragma once
// What a run is made of: nodes as they are described, links, and where results go.

#include "cosim/conductor.h"
#include "ends/port_relay.h"
#include "run/description/node_description.h"
#include "scenarios/description/scenario.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

struct PlannedNode {
    std::string name;  ///< unique in the run: "robot0.pic"
    NodeDescription what;
    std::optional<bool> in_process{};  ///< as of cosim::NodeSpec, like the others
    bool any_thread = false;
    bool outside = false;
    unsigned host = 0;
};

struct RunSetup {
    scenarios::Scenario scenario;
    std::string scenario_sha256{};  ///< of its file, as it was read
    std::filesystem::path out;
    std::vector<PlannedNode> nodes;
    std::vector<cosim::LinkSpec> links;
    std::string control{};                    ///< socket at which the world takes commands; empty: none
    std::vector<exec::RelayedPort> joined{};  ///< ports on loopback that lead into the network
    std::vector<std::string> warnings{};      ///< what looks like a mistake
    std::string cache_unused{};               ///< why no boot is taken from the cache; empty: no such reason
    std::filesystem::path save_state{};       ///< where the boards' states at `save_at` go; empty: nowhere
    cosim::Time save_at = 0;
    std::filesystem::path from{};  ///< snapshot that the run goes on from; empty: none
    cosim::Time from_time = 0;     ///< of that
    cosim::Time ready = 0;         ///< in real time: the boards are ready, the wall clock counts from here
};

/// The node as the conductor takes it.
cosim::NodeSpec node_spec(const PlannedNode& node);
std::vector<cosim::NodeSpec> node_specs(const RunSetup& setup);

}  // namespace puckloop::tools
