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
                           std::span<const PortEcho> echoes, std::vector<Message>& outbox) {
    std::optional<Advanced> done = begin(reach, inbox, echoes, outbox);
    while (!done)
        done = resume(true, outbox);
    return *done;
}

std::optional<Advanced> RunAhead::begin(const Reach& reach, std::span<const Message> inbox,
                                        std::span<const PortEcho> echoes, std::vector<Message>& outbox) {
    outbox.clear();
    reach_ = reach;
    sent_before_.clear();
    wrong_ = kNever;
    if (goes_in_strides(echoes) &&
        (node_->suspendable() == nullptr || !echoes.empty() || reach.until <= reached_)) {
        const Time from = reached_;
        reached_ = ahead_ = advance_in_strides(*node_, from, reach, inbox, echoes, outbox);
        note_advance(from, reached_, take_before(reached_, inbox).size());
        return Advanced{reached_, ahead_, outbox.size()};
    }
    if (reach.until < reached_) throw RunError("was granted time that it had passed");
    wrong_ = first_difference(inbox);
    if (reach.ahead <= reach.until) wrong_ = std::min(wrong_, reach.until);
    std::vector<Message> again;
    const bool back = wrong_ < ahead_;
    if (back) {
        sent_before_ = sent_;
        // From the mark, with what was final already and what is known now.
        again = used_before_reached();
        again.insert(again.end(), inbox.begin(), inbox.end());
        inbox = again;
        take_back();
    } else {
        take_before(ahead_, inbox);
    }
    if (back && ahead_ == reach.until && reach.ahead > reach.until) {
        forget_lookaheads();  // nothing more is sure: the mark stays good
    } else if (ahead_ <= reach.until) {
        if (!begin_sure(inbox)) {
            rest_.assign(inbox.begin(), inbox.end());
            return std::nullopt;
        }
        end_sure(outbox);
    }
    return go_ahead(inbox, outbox);
}

std::optional<Advanced> RunAhead::resume(bool wait, std::vector<Message>& outbox) {
    if (!node_->suspendable()->resume(wait)) return std::nullopt;
    ahead_ = reach_.until;
    end_sure(outbox);
    return go_ahead(rest_, outbox);
}

/// One that is granted on its own echo's account is not run ahead, even if it could be.
bool RunAhead::goes_in_strides(std::span<const PortEcho> echoes) const {
    return !marked_ && (!echoes.empty() || node_->rewindable() == nullptr);
}

/// Up to where everything is final; false if the node has left that for now.
bool RunAhead::begin_sure(std::span<const Message>& inbox) {
    if (ahead_ == reach_.until) return true;
    // What now happens may be what cannot be taken back.
    if (marked_ && bounded_ != nullptr) {
        node_->rewindable()->settle();
        marked_ = false;
    }
    if (node_->suspendable() == nullptr) {
        execute(reach_.until, inbox);
        return true;
    }
    const auto due = take_before(reach_.until, inbox);
    note_advance(ahead_, reach_.until, due.size());
    if (!node_->suspendable()->begin(reach_.until, due, sent_)) return false;
    ahead_ = reach_.until;
    return true;
}

void RunAhead::end_sure(std::vector<Message>& outbox) {
    if (marked_) node_->rewindable()->settle();
    marked_ = false;
    used_.clear();
    outbox.swap(sent_);
}

/// Everything before reach_.until is final, and in the outbox where it was not before.
Advanced RunAhead::go_ahead(std::span<const Message> inbox, std::vector<Message>& outbox) {
    const std::size_t sure = outbox.size();
    reached_ = reach_.until;
    if (reach_.ahead > std::max(ahead_, no_further_)) run_on(reach_.ahead, inbox);
    stopped_at_ = bounded_ != nullptr && ahead_ < reach_.ahead ? ahead_ : kNever;
    outbox.insert(outbox.end(), sent_.begin(), sent_.end());
    check_same(sent_before_, outbox, wrong_);
    return {reached_, ahead_, sure};
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
    ++work_.rewinds;
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
    note_advance(ahead_, until, due.size());
    if (marked_) used_.insert(used_.end(), due.begin(), due.end());
    ahead_ = until;
}

/// At most `until`, but no further than the node can come back from.
Time RunAhead::may_reach(Time until, std::span<const Message> inbox) const {
    if (bounded_ == nullptr) return until;
    const auto end = std::find_if(inbox.begin(), inbox.end(),
                                  [&](const Message& m) { return m.time > inbox.front().time; });
    return std::min(until, bounded_->horizon({inbox.begin(), end}));
}

/// Beyond what is final. The node is cut at each message, since what it claims of its lookaheads holds until
/// the next one comes in.
void RunAhead::run_on(Time until, std::span<const Message>& inbox) {
    if (may_reach(until, inbox) <= ahead_) return;
    if (!marked_) {
        node_->rewindable()->mark();
        ++work_.marks;
        marked_ = true;
        mark_ = ahead_;
        forget_lookaheads();
    }
    try {
        for (Time end = until; (end = may_reach(until, inbox)) > ahead_;) {
            if (inbox.empty() || inbox.front().time >= end || (bounded_ == nullptr && !answers_late())) {
                execute_noting(end, inbox);
            } else {
                take_in(inbox);
            }
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

/// The next messages, all of one time.
void RunAhead::take_in(std::span<const Message>& inbox) {
    const Time time = inbox.front().time;
    if (ahead_ < time) execute_noting(time, inbox);
    execute_noting(time + 1, inbox);
}

/// As execute(), up to just behind every earliest output time on its way: what a port claims there and then
/// holds for what comes in until then. An output that was due at P and is not any more, because of what came
/// in or without it, would come after all if something else came in: that limits the lookahead to the time
/// that was left until P. Nor need anything come in: a bus asks its boards some time after a START, and only
/// then answers sooner than before.
void RunAhead::execute_noting(Time until, std::span<const Message>& inbox) {
    for (Time cut = ahead_; cut < until;) {
        note_earliest_outputs();
        cut = until;
        for (const Time earliest : earliest_outputs_)
            if (earliest >= ahead_) cut = std::min(cut, cosim::later(earliest, 1));
        const std::size_t first = sent_.size();
        execute(cut, inbox);
        for (std::size_t p = 0; p < earliest_outputs_.size(); ++p) {
            const auto port = static_cast<PortIndex>(p);
            const Time earliest = earliest_outputs_[p];
            if (node_->earliest_output(port) <= earliest) continue;
            const bool kept =
                std::any_of(sent_.begin() + static_cast<std::ptrdiff_t>(first), sent_.end(),
                            [&](const Message& m) { return m.port == port && m.time == earliest; });
            if (!kept) lookaheads_[p] = std::min(lookaheads_[p], std::max<Time>(0, earliest - (cut - 1)));
        }
        sample_lookaheads();
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
    state.bounded = bounded_ != nullptr;
    state.horizon = bounded_ == nullptr ? kNever : std::min(stopped_at_, bounded_->horizon({}));
    if (marked_)
        for (std::size_t p = 0; p < lookaheads_.size(); ++p)
            state.ports[p].lookahead = std::min(state.ports[p].lookahead, lookaheads_[p]);
    if (ahead_ == reached_) return;
    if (state.stop && state.stop->time >= reached_) state.stop.reset();
    if (state.wound_up >= reached_) state.wound_up = kNever;
}

void RunAhead::wind_up(int signal) {
    if (ahead_ != reached_) throw RunError("is to end while it runs ahead");
    if (marked_) node_->rewindable()->settle();
    marked_ = false;
    used_.clear();
    node_->wind_up(reached_, signal);
}

std::vector<std::uint8_t> RunAhead::save() {
    if (!stateful_ || ahead_ != reached_) throw RunError("is to be saved while it runs ahead");
    if (marked_) node_->rewindable()->settle();
    marked_ = false;
    used_.clear();
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    const StatefulNode& node = *stateful_;
    node.state(writer);
    return bytes;
}

void RunAhead::load(Time time, std::span<const std::uint8_t> state) {
    if (!stateful_ || ahead_ != 0) throw RunError("is to be loaded where that cannot be");
    try {
        StateReader reader(state);
        stateful_->state(reader);
        reader.end();
    } catch (const StateError& error) {
        throw InputError("", std::string(node_->name()),
                         std::string("its state does not fit: ") + error.what());
    }
    reached_ = ahead_ = time;
}

void RunAhead::note_advance(Time from, Time to, std::size_t messages) {
    ++work_.advances;
    work_.messages += messages;
    work_.executed += to - from;
}

WorkCounts RunAhead::work() const {
    WorkCounts counts{{"advances", work_.advances},
                      {"messages taken in", work_.messages},
                      {"us executed", static_cast<std::uint64_t>(work_.executed / kMicrosecond)},
                      {"marks", work_.marks},
                      {"rewinds", work_.rewinds}};
    if (const auto* counting = dynamic_cast<const CountsWork*>(node_.get())) counting->add_work(counts);
    return counts;
}

std::string RunAhead::finish() {
    if (ahead_ != reached_) back_to_reached();
    if (marked_) node_->rewindable()->settle();
    return node_->finish();
}

}  // namespace puckloop::cosim
