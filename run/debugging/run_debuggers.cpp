#include "run/debugging/run_debuggers.h"

#include "run/debugging/debugged_node.h"
#include "run/factory/node_factory.h"

#include <fmt/format.h>

#include <poll.h>

#include <algorithm>
#include <utility>

namespace puckloop::tools {

RunDebuggers::RunDebuggers(const RunSetup& setup, const RunRequest& request,
                           const volatile std::sig_atomic_t* abort_requested)
    : origin_(request.snapshot),
      abort_requested_(abort_requested),
      no_way_back_(why_not_back(setup, request)) {
    for (const PlannedNode& node : setup.nodes)
        if (const std::string& place = node.what.care.gdb; !place.empty())
            boards_.push_back(std::make_unique<BoardDebugger>(*this, boards_.size(), node.name, place));
}

std::unique_ptr<cosim::Node> RunDebuggers::make_node(const std::string& text) {
    NodeDescription node = decode(text);
    if (node.care.gdb.empty()) return tools::make_node(node);
    const auto debugger = std::find_if(boards_.begin(), boards_.end(), [&](const auto& board) {
        return board->name() == board_fields(node).name;
    });
    return make_debugged(make_board(node), **debugger);
}

void RunDebuggers::keep_past(cosim::RunOptions& options, RunWritten written) {
    if (!no_way_back_.empty()) return;
    options.save_next = [this](cosim::Time after) { return history_.next(after); };
    options.save = [this, written, to_file = options.save,
                    at = options.save_at](cosim::RunSnapshot& snapshot) {
        if (std::find(at.begin(), at.end(), snapshot.time) != at.end()) to_file(snapshot);
        history_.take(snapshot, written.place(places()));
    };
}

std::vector<RunHistory::Board> RunDebuggers::places() const {
    std::vector<RunHistory::Board> places;
    for (const auto& board : boards_)
        places.push_back({board->cycle(), board->changes_made()});
    return places;
}

void RunDebuggers::begin_history() {
    if (!history_.begun()) history_.begin(origin_, {.boards = places()});
}

const cosim::RunSnapshot* RunDebuggers::begin_again() {
    const RunHistory::Place& place = history_.place(plan_->instant);
    for (const auto& board : boards_)
        board->go_back(place.boards[board->index()].changes);
    debug::StopControl& stops = boards_[plan_->who]->stops();
    if (plan_->position)
        stops.seek_inside(*plan_->position);
    else
        stops.search_inside(plan_->step, plan_->limit);
    kept_.reset();
    if (plan_->instant > 0) kept_ = place;
    from_ = history_.snapshot(plan_->instant);
    return from_.get();
}

const RunHistory::Place* RunDebuggers::kept() const {
    return kept_ ? &*kept_ : nullptr;
}

void RunDebuggers::stand_still(BoardDebugger& who, const debug::Stop& stop, bool inside) {
    plan_.reset();
    who.on_stop(stop, inside);
    const auto stands = [](const auto& board) { return board->stands(); };
    while (std::any_of(boards_.begin(), boards_.end(), stands)) {
        bool any = false;
        for (const auto& board : boards_)
            any = board->poll() || any;
        // The user ends the run at its own terminal, at once.
        if (abort_requested_ != nullptr && *abort_requested_ != 0)
            for (const auto& board : boards_)
                board->let_go();
        else if (!any)
            wait();
    }
}

/// For something to come from a debugger, a tenth of a second at most.
void RunDebuggers::wait() const {
    constexpr int kPatienceMs = 100;
    std::vector<pollfd> asked;
    for (const auto& board : boards_)
        asked.push_back({board->descriptor(), POLLIN, 0});
    ::poll(asked.data(), asked.size(), kPatienceMs);
}

std::string RunDebuggers::no_way_back(const BoardDebugger& who) const {
    if (!no_way_back_.empty()) return no_way_back_;
    for (const auto& board : boards_)
        if (board.get() != &who && board->stands())
            return fmt::format("{} is stopped at a debugger of its own: let it go on first", board->name());
    return {};
}

void RunDebuggers::go_back(BoardDebugger& who, bool step) {
    const auto instant = history_.before(who.index(), who.cycle());
    if (!instant) return;
    for (const auto& board : boards_)
        board->remember_present();
    plan_ = Plan{.who = who.index(), .step = step, .instant = *instant, .limit = who.position()};
    throw cosim::Reverted{};
}

void RunDebuggers::stopped(BoardDebugger& who) {
    if (plan_ && !plan_->position) search_over(who);
    const debug::Stop stop = plan_ ? plan_->stop : who.stops().stopped().value_or(debug::Stop{});
    stand_still(who, stop, true);
}

void RunDebuggers::passed(BoardDebugger& who, cosim::Time until) {
    if (!plan_ || plan_->who != who.index() || plan_->position) return;
    // No instruction began at the limit: the chip slept.
    if (until > who.time_of(plan_->limit / 2)) search_over(who);
}

void RunDebuggers::search_over(BoardDebugger& who) {
    const std::uint64_t begin = 2 * history_.place(plan_->instant).boards[who.index()].cycle;
    if (const auto& found = who.stops().found()) {
        plan_->position = found->position;
        plan_->stop = found->stop;
    } else if (plan_->instant == 0) {
        plan_->position = begin;
        plan_->stop = {debug::Stop::Why::Begin};
    } else {
        plan_->limit = begin;
        plan_->instant -= std::min(plan_->instant, plan_->next);
        plan_->next *= 2;
    }
    throw cosim::Reverted{};
}

}  // namespace puckloop::tools
