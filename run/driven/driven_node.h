#pragma once
// A board of a run that a client drives: between two advances the client may read and change its chip, and
// end the run.

#include "emu/chip/instrument.h"
#include "run/chips/board_around.h"
#include "run/chips/board_chip.h"

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class DrivenNode final : public BoardAround, private chip::Instrument {
  public:
    explicit DrivenNode(std::unique_ptr<cosim::StatefulNode> board);

    debug::DebugChip& chip() { return *chip_.chip; }
    /// When the instruction that comes next begins: at or after reached(). A chip that waits has none; its
    /// time is that of its next cycle.
    cosim::Time next_instruction() const;
    /// A change that may have the board send something: it is made before the next instruction.
    void change_later(std::function<void(debug::DebugChip&)> change) {
        changes_.push_back(std::move(change));
    }
    bool changes_wait() const { return !changes_.empty(); }
    /// From now on the interrupts and traps that are taken are counted, or not any more. While they are the
    /// chip interprets every instruction, which changes nothing but the time that it takes.
    void count_interrupts(bool on);
    struct InterruptCounts {
        cosim::Time from = 0;                ///< since the node's advance that ended there
        std::map<int, std::uint64_t> taken;  ///< by vector
    };
    /// Null: they are not counted.
    const InterruptCounts* interrupt_counts() const { return counts_ ? &*counts_ : nullptr; }
    /// The end of the last advance.
    cosim::Time reached() const { return reached_; }
    /// The run ends with this at the node's next advance.
    void ask_to_stop(cosim::Stop stop) { stop_wanted_ = std::move(stop); }

    /// The client may change the chip at any instant.
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        return earliest_if_changed(port, reached_);
    }
    std::optional<cosim::Stop> stop() const override { return stop_; }
    using BoardAround::state;
    void state(StateReader& archive) override;
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;

  private:
    bool instruction(std::uint32_t pc, std::uint64_t cycle) override;
    void interrupt(int vector, std::uint32_t pc, std::uint64_t cycle) override;
    void access(std::uint16_t, int, bool) override {}

    std::vector<std::function<void(debug::DebugChip&)>> changes_;
    std::optional<InterruptCounts> counts_;
    BoardChip chip_;
    cosim::Time reached_ = 0;
    std::optional<cosim::Stop> stop_, stop_wanted_;
};

}  // namespace puckloop::tools
