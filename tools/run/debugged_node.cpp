#include "tools/run/debugged_node.h"

#include "base/error.h"
#include "emu/avr/chip.h"
#include "emu/dspic/chip/chip.h"
#include "emu/pic/pic_node.h"
#include "emu/rab_board/rab_node.h"
#include "emu/tam_avr/tam_node.h"
#include "tools/debug/gdb_session.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace puckloop::tools {

namespace {

using debug::Resume;
using debug::Stop;

/// Instructions between two looks at what the debugger sent.
constexpr unsigned kLookEvery = 4096;

class DebuggedNode final : public cosim::StatefulNode, private debug::Debuggee, private chip::Instrument {
  public:
    DebuggedNode(std::unique_ptr<cosim::StatefulNode> board, const std::string& place)
        : board_(std::move(board)),
          chip_(chip_of(*board_)),
          control_(*chip_),
          socket_("--gdb", place),
          session_(socket_, *this, nullptr) {
        std::fprintf(stderr, "gdb: %s at %s\n", std::string(name()).c_str(), socket_.address().c_str());
        std::fflush(stderr);
    }

    std::string_view name() const override { return board_->name(); }
    std::span<const cosim::Port> ports() const override { return board_->ports(); }
    cosim::Time earliest_output(cosim::PortIndex port) const override {
        return board_->earliest_output(port);
    }
    cosim::Time lookahead(cosim::PortIndex port) const override { return board_->lookahead(port); }
    std::optional<cosim::Time> begun(cosim::PortIndex port) const override { return board_->begun(port); }
    std::optional<cosim::Stop> stop() const override { return stop_; }
    void state(StateWriter& archive) const override {
        const cosim::StatefulNode& board = *board_;
        board.state(archive);
    }
    void state(StateReader& archive) override { board_->state(archive); }
    void renew_random_streams() override { board_->renew_random_streams(); }
    std::string finish() override {
        chip_->set_instrument(nullptr, false);
        session_.over(0);
        return board_->finish();
    }

    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override {
        if (!std::exchange(met_, true)) {
            socket_.accept(nullptr);
            serve({}, false);
        } else if (session_.wants_stop()) {
            serve({Stop::Why::Interrupt}, false);
        }
        if (std::exchange(reset_, false)) press_reset_();
        if (killed_ && !stop_)
            stop_ = cosim::Stop{until, false, std::string(name()) + ": ended by the debugger"};
        // Without a debugger nobody looks.
        chip_->set_instrument(socket_.connected() ? this : nullptr, true);
        board_->advance(until, inbox, outbox);
    }

  private:
    debug::DebugChip& chip() override { return *chip_; }
    debug::StopControl& control() override { return control_; }
    bool reverses() const override { return false; }
    std::string frozen() const override { return {}; }
    bool change(std::function<bool(debug::DebugChip&)> change) override { return change(*chip_); }
    void press_reset() override { reset_ = true; }
    double seconds() const override { return cosim::to_seconds(clock_->time_of(chip_->cycle())); }
    std::string summary() override {
        return fmt::format("{} cycles, {} instructions\n", chip_->cycle(), chip_->instructions());
    }

    bool instruction(std::uint32_t pc, std::uint64_t cycle) override {
        if (!socket_.connected()) return true;
        if (!control_.instrument().instruction(pc, cycle)) {
            serve(control_.stopped().value_or(Stop{}), true);
        } else if (++looked_ % kLookEvery == 0 && session_.wants_stop()) {
            serve({Stop::Why::Interrupt}, true);
        }
        return true;
    }
    void access(std::uint16_t address, int bytes, bool write) override {
        control_.instrument().access(address, bytes, write);
    }

    /// `inside`: before an instruction, which is executed when this returns.
    void serve(const Stop& stop, bool inside) {
        control_.pause();
        const Resume resume = session_.serve(stop);
        if (resume == Resume::Kill) killed_ = true;
        if (resume == Resume::Kill || resume == Resume::Detach) control_.clear();
        control_.begin_inside(resume == Resume::Step, inside);
    }

    std::unique_ptr<debug::DebugChip> chip_of(cosim::Node& node) {
        const auto of_dspic = [this](dspic::Chip& chip) {
            clock_ = &chip.clock();
            press_reset_ = [&chip] { chip.mclr(); };
            return debug::make_debug_chip(chip);
        };
        if (auto* pic = dynamic_cast<pic::PicNode*>(&node)) return of_dspic(pic->chip());
        if (auto* rab = dynamic_cast<rab::RabNode*>(&node)) return of_dspic(rab->chip());
        if (auto* tam = dynamic_cast<tam::TamNode*>(&node)) {
            avr::Chip& chip = tam->board().chip();
            clock_ = &chip.clock();
            press_reset_ = [&chip] { chip.external_reset(); };
            return debug::make_debug_chip(chip);
        }
        throw InputError("", "--gdb", std::string(node.name()) + " has no chip", "a board of the run");
    }

    std::unique_ptr<cosim::StatefulNode> board_;
    const cosim::ClockDomain* clock_ = nullptr;
    std::function<void()> press_reset_;
    std::unique_ptr<debug::DebugChip> chip_;
    debug::StopControl control_;
    debug::GdbSocket socket_;
    debug::GdbSession session_;
    std::optional<cosim::Stop> stop_;
    bool met_ = false, killed_ = false, reset_ = false;
    unsigned looked_ = 0;
};

}  // namespace

std::unique_ptr<cosim::Node> make_debugged(std::unique_ptr<cosim::StatefulNode> board,
                                           const std::string& place) {
    return std::make_unique<DebuggedNode>(std::move(board), place);
}

}  // namespace puckloop::tools
