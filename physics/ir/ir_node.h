#pragma once
// The infra-red medium between range-and-bearing boards as a node: emitters in, demodulator outputs and
// strength levels out.
//
// Ports: "<robot>.ir" for each robot of the description with a board, in its order, then "world" with the
// poses (physics/world/pose_signals.h). Signal ids come from each robot's rab_signals: the medium reads
// "emitter1".."12", "carrier" (Hz) and "power" (potentiometer byte) and writes "demod1".."12" and
// "peak1".."12" (counts), each at the exact time of its cause plus its delay, ir.delay_on, ir.delay_off or
// ir.level_delay. The shortest of them is what the boards can run ahead of each other. Poses take effect when
// a burst begins.

#include "base/fields/field.h"
#include "cosim/core/node.h"
#include "cosim/faults/fault_json.h"
#include "physics/description/world_form.h"

#include <memory>

namespace puckloop::physics {

struct IrNodeOptions {
    std::string name = "ir";
    std::string frames_csv{};
    bool changes = false;
    std::vector<cosim::CarriedFault> faults{};  ///< of the light (physics/ir/ir_faults.h)

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("name", &IrNodeOptions::name, "of the node"),
                     field("csv", &IrNodeOptions::frames_csv,
                           "file for what was on the air (physics/ir/ir_frames.h); empty: none"),
                     field("changes", &IrNodeOptions::changes,
                           "events change the world: the port \"world\" has more than poses"),
                     unlisted(&IrNodeOptions::faults));
    }
};
static_assert(lists_all_fields<IrNodeOptions>);

/// The medium as a run describes it.
struct IrSpec {
    static constexpr std::string_view kKind = "ir";

    World world{};
    IrNodeOptions options{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(field("world", &IrSpec::world, "robots, walls and light").required().as<WorldForm>(),
                     part(&IrSpec::options));
    }
};
static_assert(lists_all_fields<IrSpec>);

class IrNode final : public cosim::Node {
  public:
    /// Throws InputError on an impossible world or one without boards, RunError when the file cannot be
    /// written.
    IrNode(const World& world, const IrNodeOptions& options);
    ~IrNode() override;

    std::string_view name() const override;
    std::span<const cosim::Port> ports() const override;
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    cosim::Rewindable* rewindable() override;
    /// {"boards": [...], "faults": [...]}: frames on the air as each board could hear them.
    std::string finish() override;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace puckloop::physics
