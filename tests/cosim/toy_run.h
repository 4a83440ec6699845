#pragma once
// Shortens tests: toy runs with a recording sink.

#include "cosim/conductor.h"
#include "toy_nodes.h"

#include <string>
#include <vector>

namespace puckloop::cosim::toy {

inline const std::vector<std::string> kNodeCommand{PUCKLOOP_TOY_NODE, "node"};

struct Recorder : TraceSink {
    std::vector<TraceRecord> records;
    bool flushed = false;
    void begin(const std::vector<LinkSpec>&) override {}
    void record(const TraceRecord& record) override { records.push_back(record); }
    void flush() override { flushed = true; }
};

struct Run {
    std::vector<NodeSpec> nodes;
    std::vector<LinkSpec> links;
    std::vector<FaultSpec> faults{};
    RunOptions options{};

    /// In this process unless the options or a node say otherwise.
    Outcome operator()(Recorder* recorder = nullptr) const {
        RunOptions with = options;
        with.node_command = kNodeCommand;
        Conductor conductor(nodes, links, faults, with, make);
        if (recorder) conductor.add_sink(*recorder);
        return conductor.run();
    }
};

inline LinkSpec uart(const std::string& name, const PortRef& a, const PortRef& b) {
    return {name, a, b, 115200.0};
}

/// `count` chatter nodes on a random connected graph; deterministic in `seed`.
Run random_chatter(std::uint64_t seed, int count);

}  // namespace puckloop::cosim::toy
