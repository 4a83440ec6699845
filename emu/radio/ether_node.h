#pragma once
// The radio medium as a node: one radio port for each module, at a fixed place. MAC and network layer of all
// modules live here (mac.h, mesh.h), so that hops and acknowledgements cross no link; what a module gives and
// gets are whole network frames (protocols/mesh_frame.h) and words of control.h.
//
// Modules hear one another only on the same channel with the same PAN id.

#include "cosim/core/node.h"
#include "emu/radio/mesh.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::radio {

struct EtherStation {
    std::string name;  ///< of the port
    Position at{};     ///< m
};

struct EtherSpec {
    std::string name = "ether";
    std::uint64_t seed = 1;
    Propagation propagation{};
    cosim::Time processing = cosim::kMillisecond;  ///< between hearing a frame and handing it on, > 0
    std::vector<EtherStation> stations{};
    std::vector<cosim::CarriedFault> faults{};
};

class EtherNode : public cosim::Node, private MeshUser {
  public:
    /// Throws InputError for numbers out of range.
    explicit EtherNode(const EtherSpec& spec);

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex /*port*/) const override { return Mesh::lookahead(); }
    /// JSON: "stations": {name: counters}, "hops", "warnings"; with faults "faults"
    /// (cosim/faults/fault_json.h).
    std::string finish() override;

    const Mesh& mesh() const { return mesh_; }

  private:
    void receive(const cosim::Message& message);
    void set(std::size_t station, const RadioSettings& settings, cosim::Time now);
    void deliver(std::size_t station, const protocols::MeshFrame& frame, const Heard& heard) override;
    void report(std::size_t station, const RadioOutcome& outcome, cosim::Time now) override;

    EtherSpec spec_;
    std::vector<cosim::Port> ports_;
    Medium medium_;
    AirFaults faults_;
    Mesh mesh_;
    std::vector<cosim::Message>* outbox_ = nullptr;
    cosim::Time granted_ = 0;
    std::vector<std::string> warnings_;  ///< each once
};

/// From JSON: {"name", "seed", "range_m", "exponent", "loss", "processing_s", "stations": [{"name", "at"}]},
/// "faults": [...], all but a station's fields optional. Throws InputError.
std::unique_ptr<cosim::Node> make_ether_node(std::string_view json);

}  // namespace puckloop::radio
