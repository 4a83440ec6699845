#pragma once
// The radio medium as a node: one radio port for each module, at a fixed place. MAC and network layer of all
// modules live here (mac.h, mesh.h), so that hops and acknowledgements cross no link; what a module gives and
// gets are whole network frames (protocols/radio/mesh_frame.h) and words of control.h.
//
// Modules hear one another only on the same channel with the same PAN id.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/core/seconds_form.h"
#include "emu/radio/mesh.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::radio {

struct EtherStation {
    std::string name;
    Position at{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &EtherStation::name, "of the port").required(),
                     field("at", &EtherStation::at, "where the aerial is").in("m").required());
    }
};
static_assert(lists_all_fields<EtherStation>);

struct EtherSpec {
    static constexpr std::string_view kKind = "ether";

    std::string name = "ether";
    std::uint64_t seed = 1;
    Propagation propagation{};
    cosim::Time processing = cosim::kMillisecond;
    std::vector<EtherStation> stations{};
    std::vector<cosim::CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("name", &EtherSpec::name, "of the node"), field("seed", &EtherSpec::seed, "of the run"),
            part(&EtherSpec::propagation),
            field("processing_s", &EtherSpec::processing, "between hearing a frame and handing it on")
                .in("s")
                .above(0)
                .as<cosim::Seconds>(),
            field("stations", &EtherSpec::stations, "the modules").required(), unlisted(&EtherSpec::faults));
    }
};
static_assert(lists_all_fields<EtherSpec>);

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

}  // namespace puckloop::radio
