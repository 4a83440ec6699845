#pragma once
// The skeleton of a board as a node: from message to message, with resets and faults where they are due.
//
// A node derives from BoardNode<itself> and befriends it. It has
//   log_                 with next_look(), the time of the next look at the chip
//   look()               that look
//   run_board(until)     the board to this time of the run; faults that wait for the program act on the way
//   settle(until)        what the board does by itself before `until`
//   push_reset_button()
//   receive(message)     the board is at its time
// and may have, in place of those below, takes_ahead(message) and held_back().

#include "cosim/core/stateful_node.h"
#include "emu/board/fault_parts.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::board {

template <class Self>
class BoardNode : public cosim::StatefulNode, protected chip::BoardAccess {
  public:
    std::string_view name() const final { return name_; }
    std::span<const cosim::Port> ports() const final { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) final {
        outbox_ = &outbox;
        for (const cosim::Message& message : inbox) {
            if (self().takes_ahead(message)) continue;
            run_resets(message.time, true);
            run_faults(message.time, true);
            run_until(message.time);
            self().receive(message);
        }
        // What is due at `until` itself belongs to the next grant: what this one sends must not depend on the
        // cut.
        run_resets(until, false);
        run_faults(until, false);
        run_until(until);
        self().settle(until);
        granted_ = until;
        outbox_ = nullptr;
    }
    /// The end of the last advance.
    cosim::Time granted() const { return granted_; }

  protected:
    /// `resets`: rising times at which the reset button is pressed.
    BoardNode(std::string name, std::vector<cosim::Port> ports, std::vector<cosim::Time> resets)
        : ports_(std::move(ports)), name_(std::move(name)), resets_(std::move(resets)) {}

    /// Of the resets, the one that comes next; nothing after the last.
    std::optional<cosim::Time> next_reset() const {
        if (next_reset_ == resets_.size()) return std::nullopt;
        return resets_[next_reset_];
    }

    /// For checkpoints, which hold what follows from the time as well.
    template <class Archive, class Whole>
    static void list_node(Archive& archive, Whole& whole) {
        archive(whole.granted_, whole.next_reset_);
    }
    /// After loading granted_: a press at the very time of the state is still to come.
    void find_next_reset() {
        next_reset_ = static_cast<std::size_t>(std::lower_bound(resets_.begin(), resets_.end(), granted_) -
                                               resets_.begin());
    }
    /// What leaves during `act` goes to `outbox`; `act` gets whether the node is being advanced meanwhile.
    template <class Act>
    void collect(std::vector<cosim::Message>& outbox, Act act) {
        auto* const before = std::exchange(outbox_, &outbox);
        act(before != nullptr);
        outbox_ = before;
    }

    std::vector<cosim::Port> ports_;
    /// Null: none was asked for, nor was there any in a loaded state.
    std::unique_ptr<chip::BoardFaults> faults_;
    std::vector<cosim::Message>* outbox_ = nullptr;  ///< null between advances
    cosim::Time granted_ = 0;

    /// True if the message is taken, before its time: what it changes is seen to wherever it counts.
    static bool takes_ahead(const cosim::Message&) { return false; }
    /// True if the board's last run ended early (dspic::LookGate).
    static bool held_back() { return false; }
    /// The board to `until`, with its looks on the way.
    void run_until(cosim::Time until) {
        for (cosim::Time look = self().log_.next_look(); look <= until; look = self().log_.next_look()) {
            self().run_board(look);
            if (self().held_back()) return;
            self().settle(look);
            self().look();
        }
        self().run_board(until);
    }

  private:
    Self& self() { return static_cast<Self&>(*this); }

    /// Presses the reset button where it is due before (or at) `until`.
    void run_resets(cosim::Time until, bool inclusive) {
        while (next_reset_ < resets_.size()) {
            const cosim::Time time = resets_[next_reset_];
            if (time > until || (time == until && !inclusive)) return;
            run_faults(time, false);
            run_until(time);
            self().push_reset_button();
            ++next_reset_;
        }
    }
    /// Lets the faults act that are due before (or at) `until`.
    void run_faults(cosim::Time until, bool inclusive) {
        act_until(faults_.get(), until, inclusive, [this](cosim::Time time) { run_until(time); });
    }

    std::string name_;
    std::vector<cosim::Time> resets_;
    std::size_t next_reset_ = 0;
};

}  // namespace puckloop::board
