#include "run/debugging/board_debugger.h"

#include "base/error.h"
#include "run/chips/board_chip.h"
#include "run/debugging/run_debuggers.h"

#include <fmt/format.h>

#include <cstdio>
#include <utility>

namespace puckloop::tools {

using debug::Resume;
using debug::Stop;

namespace {

/// Instructions between two looks at what the debugger sent.
constexpr unsigned kInstructionsBetweenLooks = 4096;

}  // namespace

BoardDebugger::BoardDebugger(RunDebuggers& run, std::size_t index, std::string name, const std::string& place)
    : run_(run),
      index_(index),
      name_(std::move(name)),
      socket_("--gdb", place),
      session_(socket_, *this, nullptr) {
    fmt::print(stderr, "gdb: {} at {}\n", name_, socket_.address());
    std::fflush(stderr);
}

void BoardDebugger::set_board(cosim::Node& board) {
    BoardChip found = chip_of(board);
    if (!found.chip) throw InputError("", "--gdb", name_ + " has no chip", "a board of the run");
    chip_ = std::move(found.chip);
    clock_ = found.clock;
    granted_ = std::move(found.granted);
    press_reset_ = std::move(found.press_reset);
    control_.set_chip(*chip_);
}

chip::Instrument* BoardDebugger::begin_advance(cosim::Time now, std::vector<cosim::Message>& outbox) {
    now_ = now;
    inside_ = false;
    outbox_ = &outbox;
    if (run_.repeats()) return this;
    if (!met_) {
        run_.begin_history();
        run_.stand_still(*this, {}, false);
    } else if (session_.wants_stop()) {
        run_.stand_still(*this, {Stop::Why::Interrupt}, false);
    }
    if (reset_) press_reset();
    // Without a debugger nobody looks, unless there is something to be done again.
    return socket_.connected() || made_ < changes_.size() ? this : nullptr;
}

std::optional<cosim::Time> BoardDebugger::next_change(cosim::Time until) const {
    if (made_ == changes_.size() || changes_[made_].inside || changes_[made_].time >= until)
        return std::nullopt;
    return changes_[made_].time;
}

void BoardDebugger::repeat_changes(cosim::Time now) {
    for (; made_ < changes_.size() && !changes_[made_].inside && changes_[made_].time <= now; ++made_)
        changes_[made_].make();
}

void BoardDebugger::end_advance(cosim::Time until) {
    now_ = until;
    outbox_ = nullptr;
    run_.passed(*this, until);
}

bool BoardDebugger::instruction(std::uint32_t /*pc*/, std::uint64_t cycle) {
    if (std::exchange(begun_at_, cycle) != cycle) behind_ = false;
    reset_pending_ = false;
    while (const Change* change = next_inside(cycle)) {
        if (change->reset) break;
        repeat_change();
    }
    if (socket_.connected() && run_.listens_to(*this)) {
        if (!control_.instrument().instruction(chip_->pc(), position()))
            run_.stopped(*this);
        else if (++looked_ % kInstructionsBetweenLooks == 0 && session_.wants_stop())
            run_.stand_still(*this, {Stop::Why::Interrupt}, true);
    }
    // Whoever stops here sees the chip before its reset; then it comes again, with its first instruction.
    if (!reset_pending_ && next_inside(cycle) != nullptr) repeat_change();
    return true;
}

/// The next change, if it was made at the instruction that starts at `cycle`, or before.
const BoardDebugger::Change* BoardDebugger::next_inside(std::uint64_t cycle) const {
    if (made_ == changes_.size()) return nullptr;
    const Change& next = changes_[made_];
    return next.inside && next.cycle <= cycle ? &next : nullptr;
}

void BoardDebugger::repeat_change() {
    changing_ = true;
    changes_[made_++].make();
    changing_ = false;
}

std::uint64_t BoardDebugger::position() const {
    const std::uint64_t cycle = chip_->cycle();
    return 2 * cycle + (behind_ && begun_at_ == cycle ? 1 : 0);
}

void BoardDebugger::on_stop(const Stop& stop, bool inside) {
    control_.pause();
    stands_ = true;
    inside_ = inside;
    session_.on_stop(stop);
}

bool BoardDebugger::poll() {
    if (!stands_ || (!met_ && !socket_.connected())) {
        // A debugger that comes, wants its program to stop, or leaves.
        if (!stands_ && met_ && session_.wants_stop()) {
            on_stop({Stop::Why::Interrupt}, false);
            return true;
        }
        if (!met_ && socket_.accept_now()) {
            met_ = true;
            if (!stands_) on_stop({}, false);
            return true;
        }
        return false;
    }
    const auto wanted = session_.poll(false);
    if (wanted) resume(*wanted);
    return wanted.has_value();
}

void BoardDebugger::resume(Resume how) {
    stands_ = false;
    if (how == Resume::Kill) killed_at_ = clock_->time_of(chip_->cycle());
    if (how == Resume::Kill || how == Resume::Detach) control_.clear();
    if (how == Resume::ReverseStep || how == Resume::ReverseContinue)
        run_.go_back(*this, how == Resume::ReverseStep);  // returns only where there is nothing before
    else
        return control_.begin_inside(how == Resume::Step, inside_ && !reset_pending_);
    on_stop({Stop::Why::Begin}, inside_);
}

void BoardDebugger::go_back(std::size_t changes) {
    made_ = changes;
    reset_ = false;  // of an instant that is taken back
    outbox_ = nullptr;
    chip_.reset();
}

std::string BoardDebugger::no_way_back() const {
    return run_.no_way_back(*this);
}

std::string BoardDebugger::frozen() const {
    return position() < present_ ? "the past cannot be changed: continue to the present first" : "";
}

bool BoardDebugger::change(std::function<bool(debug::DebugChip&)> change) {
    // Again, whenever this moment comes again.
    changes_.push_back({inside_, false, chip_->cycle(), now_, [this, change] { change(*chip_); }});
    ++made_;
    return change(*chip_);
}

void BoardDebugger::reset_board() {
    press_reset_(*outbox_);
    reset_pending_ = behind_ = true;
}

void BoardDebugger::press_reset() {
    // While another board stands this one may be between two advances.
    reset_ = outbox_ == nullptr;
    if (reset_) return;
    changes_.push_back({inside_, true, chip_->cycle(), now_, [this] { reset_board(); }});
    ++made_;
    reset_board();
}

std::string BoardDebugger::summary() {
    return fmt::format("{} cycles, {} instructions\n", chip_->cycle(), chip_->instructions());
}

}  // namespace puckloop::tools
