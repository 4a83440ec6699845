#include "cosim/schedule/run_ahead.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

namespace {

/// Takes the messages before `until` off `inbox`.
std::span<const Message> take_before(Time until, std::span<const Message>& inbox) {
    const auto end =
        std::find_if(inbox.begin(), inbox.end(), [until](const Message& m) { return m.time >= until; });
    const auto count = static_cast<std::size_t>(end - inbox.begin());
    const auto first = inbox.first(count);
    inbox = inbox.subspan(count);
    return first;
}

}  // namespace

Advanced RunAhead::advance(const Reach& reach, std::span<const Message> inbox,
                           const std::vector<PortEcho>& echoes, std::vector<Message>& outbox) {
    outbox.clear();
    if (!marked_ && node_->rewindable() == nullptr) {
        reached_ = ahead_ = advance_in_strides(*node_, reached_, reach, inbox, echoes, outbox);
        return {reached_, ahead_, outbox.size()};
    }
    const Time until = reach.until;
    if (until < reached_) throw RunError("was granted time that it had passed");
    Time wrong = first_difference(inbox);
    if (reach.ahead <= until) wrong = std::min(wrong, until);
    std::vector<Message> again, sent_before;
    const bool back = wrong < ahead_;
    if (back) {
        sent_before = sent_;
        // From the mark, with what was final already and what is known now.
        again = used_before_reached();
        again.insert(again.end(), inbox.begin(), inbox.end());
        inbox = again;
        take_back();
    } else {
        take_before(ahead_, inbox);
    }
    if (back && ahead_ == until && reach.ahead > until) {
        forget_lookaheads();  // nothing more is sure: the mark stays good
    } else if (ahead_ <= until) {
        if (ahead_ < until) execute(until, inbox);
        if (marked_) node_->rewindable()->settle();
        marked_ = false;
        used_.clear();
        outbox.swap(sent_);
    }
    const std::size_t sure = outbox.size();
    reached_ = until;
    if (reach.ahead > std::max(ahead_, no_further_)) run_on(reach.ahead, inbox);
    outbox.insert(outbox.end(), sent_.begin(), sent_.end());
    check_same(sent_before, outbox, wrong);
    return {reached_, ahead_, sure};
}

std::optional<Advanced> RunAhead::begin(const Reach& reach, std::span<const Message> inbox,
                                        const std::vector<PortEcho>& echoes, std::vector<Message>& outbox) {
    Suspendable* const node = node_->suspendable();
    if (node == nullptr || marked_ || node_->rewindable() != nullptr || !echoes.empty() ||
        reach.until <= reached_)
        return advance(reach, inbox, echoes, outbox);
    outbox.clear();
    begun_ = reach.until;
    if (!node->begin(begun_, take_before(begun_, inbox), outbox)) return std::nullopt;
    reached_ = ahead_ = begun_;
    return Advanced{reached_, ahead_, outbox.size()};
}

std::optional<Advanced> RunAhead::resume(bool wait, const std::vector<Message>& outbox) {
    if (!node_->suspendable()->resume(wait)) return std::nullopt;
    reached_ = ahead_ = begun_;
    return Advanced{reached_, ahead_, outbox.size()};
}

/// What was sent before the inbox differed must come again.
void RunAhead::check_same(const std::vector<Message>& before, const std::vector<Message>& now,
                          Time differs) const {
    for (std::size_t p = 0; p < node_->ports().size(); ++p) {
        auto other = now.begin();
        for (const Message& message : before) {
            if (message.port != p || message.time >= std::min(differs, ahead_)) continue;
            other = std::find_if(other, now.end(), [p](const Message& m) { return m.port == p; });
            if (other == now.end() || !(*other == message))
                throw RunError(fmt::format("executed again from {:.12f} s, it did not send by {} at {:.12f} "
                                           "s what it had sent (inbox differs from {:.12f} s)",
                                           to_seconds(mark_), node_->ports()[p].name,
                                           to_seconds(message.time), to_seconds(differs)));
            ++other;
        }
    }
}

/// Where the inbox is not what the node was executed with up to ahead_; kNever if it is the same.
Time RunAhead::first_difference(std::span<const Message> inbox) const {
    auto used = std::find_if(used_.begin(), used_.end(),
                             [this](const Message& message) { return message.time >= reached_; });
    auto known = inbox.begin();
    while (true) {
        const bool more = known != inbox.end() && known->time < ahead_;
        if (used == used_.end()) return more ? known->time : kNever;
        if (!more) return used->time;
        if (!(*used == *known)) return std::min(used->time, known->time);
        ++used;
        ++known;
    }
}

std::vector<Message> RunAhead::used_before_reached() const {
    std::vector<Message> sure;
    for (const Message& message : used_)
        if (message.time < reached_) sure.push_back(message);
    return sure;
}

void RunAhead::take_back() {
    node_->rewindable()->rewind();
    ahead_ = mark_;
    used_.clear();
    sent_.clear();
}

/// Nothing is foreseen afterwards; the mark stays.
void RunAhead::back_to_reached() {
    const std::vector<Message> known = used_before_reached();
    std::span<const Message> inbox(known);
    take_back();
    if (ahead_ < reached_) execute(reached_, inbox);
}

void RunAhead::execute(Time until, std::span<const Message>& inbox) {
    const auto due = take_before(until, inbox);
    node_->advance(until, due, sent_);
    if (marked_) used_.insert(used_.end(), due.begin(), due.end());
    ahead_ = until;
}

/// Beyond what is final. The node is cut at each message, since what it claims of its lookaheads holds until
/// the next one comes in.
void RunAhead::run_on(Time until, std::span<const Message>& inbox) {
    if (!marked_) {
        node_->rewindable()->mark();
        marked_ = true;
        mark_ = ahead_;
        forget_lookaheads();
    }
    try {
        while (ahead_ < until) {
            if (inbox.empty() || inbox.front().time >= until || !answers_late()) {
                execute(until, inbox);
            } else {
                take_in(inbox);
            }
            sample_lookaheads();
        }
    } catch (const std::exception&) {
        // Perhaps only because the foreseen did not come true: as far as it is sure, and no further for now.
        no_further_ = until;
        back_to_reached();
    }
}

/// Whether what comes in shows on some port only later.
bool RunAhead::answers_late() const {
    return std::any_of(lookaheads_.begin(), lookaheads_.end(), [](Time lookahead) { return lookahead > 0; });
}

/// The next messages, all of one time. What they take away would come after all if one of them did not come
/// in: a message that was due at P and is not any more limits the lookahead to P - time.
void RunAhead::take_in(std::span<const Message>& inbox) {
    const Time time = inbox.front().time;
    const auto passed = [time](Time output) { return output <= time; };
    note_earliest_outputs();
    if (ahead_ < time && std::any_of(earliest_outputs_.begin(), earliest_outputs_.end(), passed)) {
        execute(time, inbox);
        note_earliest_outputs();
    }
    const std::size_t first = sent_.size();
    execute(time + 1, inbox);
    for (std::size_t p = 0; p < earliest_outputs_.size(); ++p) {
        const auto port = static_cast<PortIndex>(p);
        const Time earliest = earliest_outputs_[p];
        if (node_->earliest_output(port) <= earliest) continue;
        const bool kept = std::any_of(sent_.begin() + static_cast<std::ptrdiff_t>(first), sent_.end(),
                                      [&](const Message& m) { return m.port == port && m.time == earliest; });
        if (!kept) lookaheads_[p] = std::min(lookaheads_[p], std::max<Time>(0, earliest - time));
    }
}

void RunAhead::note_earliest_outputs() {
    earliest_outputs_.resize(lookaheads_.size());
    for (std::size_t p = 0; p < earliest_outputs_.size(); ++p)
        earliest_outputs_[p] =
            lookaheads_[p] > 0 ? node_->earliest_output(static_cast<PortIndex>(p)) : kNever;
}

void RunAhead::forget_lookaheads() {
    lookaheads_.assign(node_->ports().size(), kNever);
    sample_lookaheads();
}

void RunAhead::sample_lookaheads() {
    for (std::size_t p = 0; p < lookaheads_.size(); ++p)
        lookaheads_[p] = std::min(lookaheads_[p], node_->lookahead(static_cast<PortIndex>(p)));
}

void RunAhead::read_state(NodeState& state) const {
    cosim::read_state(*node_, state);
    state.runs_ahead = marked_ || node_->rewindable() != nullptr;
    if (marked_)
        for (std::size_t p = 0; p < lookaheads_.size(); ++p)
            state.ports[p].lookahead = std::min(state.ports[p].lookahead, lookaheads_[p]);
    if (ahead_ == reached_) return;
    if (state.stop && state.stop->time >= reached_) state.stop.reset();
    if (state.wound_up >= reached_) state.wound_up = kNever;
}

void RunAhead::wind_up(int signal) {
    if (ahead_ != reached_) throw RunError("is to end while it runs ahead");
    node_->wind_up(reached_, signal);
}

std::string RunAhead::finish() {
    if (ahead_ != reached_) back_to_reached();
    if (marked_) node_->rewindable()->settle();
    return node_->finish();
}

}  // namespace puckloop::cosim
