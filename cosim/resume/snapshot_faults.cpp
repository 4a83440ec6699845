#include "cosim/resume/snapshot_faults.h"

#include "cosim/resume/run_snapshot.h"
#include "cosim/schedule/network.h"

#include <memory>

namespace puckloop::cosim {

namespace {

/// A node of which only name and ports are known; it is never granted anything.
class PortsOnly : public NodeHandle {
  public:
    explicit PortsOnly(const std::string& name) { name_ = name; }
    void add(const std::string& port, PortKind kind) { ports_.push_back({port, kind}); }

    void await_ready() override {}
    void grant(Reach, const std::vector<Message>&, std::span<const PortEcho>) override {}
    bool poll(bool) override { return true; }
    void wind_up(int) override {}
    std::vector<std::uint8_t> save() override { return {}; }
    void load(Time, const std::vector<std::uint8_t>&) override {}
    std::string finish() override { return {}; }
};

}  // namespace

void check_link_faults(const RunSnapshot& from, const std::vector<LinkSpec>& links,
                       std::vector<FaultSpec> faults, std::uint64_t seed) {
    std::vector<std::unique_ptr<NodeHandle>> nodes;
    std::vector<bool> has_state;
    for (const NodeSnapshot& node : from.nodes) {
        auto handle = std::make_unique<PortsOnly>(node.name);
        for (const LinkSpec& link : links) {
            // Faults sit on UART and radio links only.
            const PortKind kind = link.nominal_baud > 0 ? PortKind::Uart : PortKind::Radio;
            for (const PortRef& end : {link.a, link.b})
                if (end.node == node.name) handle->add(end.port, kind);
        }
        nodes.push_back(std::move(handle));
        has_state.push_back(node.has_state);
    }
    name_faults(faults);
    Network(nodes, links, faults, seed)
        .restore(from.wires, from.in_flight, from.time, has_state, from.unlinked);
}

}  // namespace puckloop::cosim
