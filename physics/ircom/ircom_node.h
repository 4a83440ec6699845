#pragma once
// IRcom's infra-red medium as a node: which diodes are lit goes in, the light at phototransistors comes out.
//
// Ports: "<robot>.ircom" for each robot of the description, then "<booth>.ircom" for each booth, then "world"
// with the poses (physics/world/pose_signals.h). Ids come from IrcomIds: of a robot "pulse0".."3" in and
// "ir_light0".."7" (counts) out; of a booth "proximity_emit" in and "proximity_sense" (the comparator) out.
// Light comes ircom.delay after its cause; a robot's board adds its phototransistors' time constant, the
// booth's comparator switches where its input crosses the threshold (physics/ircom/comparator.h), to the
// picosecond.
//
// A device that no other's light can reach has a lookahead of a millisecond (physics/ircom/scene.h), so that
// it need not wait for the others' every instruction.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/faults/fault_json.h"
#include "physics/description/world_form.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::physics {

/// Numbers of the boards' signals.
struct IrcomIds {
    std::array<std::uint16_t, 4> pulse{};
    std::array<std::uint16_t, 8> light{};
    std::uint16_t emit = 0, sense = 0;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("pulse", &IrcomIds::pulse, "of a main board's four pulse lines").required(),
                     field("light", &IrcomIds::light, "at its eight phototransistors").required(),
                     field("emit", &IrcomIds::emit, "of a TAM's transceiver: it emits").required(),
                     field("sense", &IrcomIds::sense, "and it sees light").required());
    }
};
static_assert(lists_all_fields<IrcomIds>);

struct IrcomNodeOptions {
    std::string name = "ircom";
    IrcomIds ids{};
    std::string words_csv{};
    bool changes = false;
    std::vector<cosim::CarriedFault> faults{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &IrcomNodeOptions::name, "of the node"), part(&IrcomNodeOptions::ids),
                     field("csv", &IrcomNodeOptions::words_csv,
                           "file for the words that were sent (physics/ircom/words.h); empty: none"),
                     field("changes", &IrcomNodeOptions::changes,
                           "events change the world: the port \"world\" has more than poses"),
                     unlisted(&IrcomNodeOptions::faults));
    }
};
static_assert(lists_all_fields<IrcomNodeOptions>);

/// The medium as a run describes it.
struct IrcomSpec {
    static constexpr std::string_view kKind = "ircom";

    World world{};
    IrcomNodeOptions options{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(
            field("world", &IrcomSpec::world, "robots, TAMs, walls and light").required().as<WorldForm>(),
            part(&IrcomSpec::options));
    }
};
static_assert(lists_all_fields<IrcomSpec>);

class IrcomNode final : public cosim::Node {
  public:
    /// Throws InputError on an impossible world, RunError when the file cannot be written.
    IrcomNode(const World& world, const IrcomNodeOptions& options);
    ~IrcomNode() override;

    std::string_view name() const override;
    std::span<const cosim::Port> ports() const override;
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    cosim::Rewindable* rewindable() override;
    /// {"devices": [...]}: words that each device sent; with faults "faults" (cosim/faults/fault_json.h).
    std::string finish() override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace puckloop::physics
