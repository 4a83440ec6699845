#pragma once
// A radio module as a node: its serial line, the pins that its socket wires, and the air.
//
// Pins carry the signals of the board that the module is plugged into; which of them lead where is by name:
//   in:  xbee_reset (1: held in reset), xbee_rts (level), xbee_wake (level of pin 9, SLEEP_RQ), power (1: it
//        has supply)
//   out: xbee_cts (level), only if the board has it
// ON/SLEEP (pin 13) leads nowhere on the boards that there are.

#include "cosim/core/node.h"
#include "emu/xbee/module.h"

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::xbee {

struct ModuleSpec {
    static constexpr std::string_view kKind = "xbee";

    ModuleOptions module{};
    std::map<std::string, std::uint16_t> pins{};

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        return visit(part(&ModuleSpec::module),
                     field("pins", &ModuleSpec::pins, "the signals of the module's board by name"));
    }
};
static_assert(lists_all_fields<ModuleSpec>);

class ModuleNode : public cosim::Node, private ModuleAir {
  public:
    static constexpr cosim::PortIndex kUart = 0, kPins = 1, kRadio = 2;

    /// `pins`: the board's signals by name. Throws InputError as Module does.
    ModuleNode(const ModuleOptions& options, const std::map<std::string, std::uint16_t>& pins);

    std::string_view name() const override { return options_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    /// JSON: address, node identifier, counters of the serial line, of commands and of the air.
    std::string finish() override;

    const Module& module() const { return module_; }

  private:
    void receive(const cosim::Message& message);
    void receive_frame(const cosim::UartFrame& frame, cosim::Time now);
    /// Everything that is due before `until`, at `until` too if `inclusive`.
    void run(cosim::Time until, bool inclusive);
    void radio_sent(std::vector<std::uint8_t> octets, cosim::Time on_air, cosim::Time now) override;
    void cts_changed(bool level, cosim::Time now) override;

    ModuleOptions options_;
    std::vector<cosim::Port> ports_;
    std::map<std::string, std::uint16_t> pins_;
    std::vector<cosim::Message> early_;  ///< what the module said when it was made
    std::vector<cosim::Message>* outbox_ = &early_;
    Module module_;
    cosim::Time granted_ = 0;
    cosim::Time heard_until_ = 0;  ///< the receiver is free from then on
};

/// A module's counters for the report, as JSON text.
std::string to_json(const Module& module);

}  // namespace puckloop::xbee
