#include "cosim/resume/resumed_node.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace puckloop::cosim {

namespace {

bool earlier(const Message& a, const Message& b) {
    return a.time < b.time;
}

/// The messages of `inbox` before `until`, which are taken off it.
std::span<const Message> before(Time until, std::span<const Message>& inbox) {
    const auto end =
        std::find_if(inbox.begin(), inbox.end(), [until](const Message& m) { return m.time >= until; });
    const auto count = static_cast<std::size_t>(end - inbox.begin());
    const auto first = inbox.first(count);
    inbox = inbox.subspan(count);
    return first;
}

}  // namespace

ResumedNode::ResumedNode(Make make, ResumeOptions options)
    : make_(std::move(make)),
      options_(std::move(options)),
      inner_(make_()),
      replaying_(options_.from.has_value()),
      recording_(options_.save_at > 0) {
    if (replaying_) index_sent();
}

/// Where each port's messages are among all that were sent.
void ResumedNode::index_sent() {
    const std::vector<Message>& sent = options_.from->sent;
    next_on_port_.assign(ports().size(), sent.size());
    after_.assign(sent.size(), sent.size());
    for (std::size_t i = sent.size(); i-- > 0;) {
        if (sent[i].port >= ports().size())
            throw RunError("a state with a port that the board does not have");
        after_[i] = std::exchange(next_on_port_[sent[i].port], i);
    }
}

void ResumedNode::advance(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    const std::size_t sent_before = outbox.size();
    if (recording_ && until >= options_.save_at) {
        const Time at = options_.save_at;
        const auto first = before(at, inbox);
        if (at > granted_) {
            replaying_ ? replay(at, first, outbox) : live(at, first, outbox);
            received_.insert(received_.end(), first.begin(), first.end());
        }
        sent_.insert(sent_.end(), outbox.begin() + static_cast<std::ptrdiff_t>(sent_before), outbox.end());
        if (recording_) hand_out_state();
        recording_ = false;
        if (until > at) live(until, inbox, outbox);
        return;
    }
    replaying_ ? replay(until, inbox, outbox) : live(until, inbox, outbox);
    if (!recording_) return;
    received_.insert(received_.end(), inbox.begin(), inbox.end());
    sent_.insert(sent_.end(), outbox.begin() + static_cast<std::ptrdiff_t>(sent_before), outbox.end());
}

void ResumedNode::live(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    inner_->advance(until, inbox, outbox);
    granted_ = until;
}

void ResumedNode::replay(Time until, std::span<const Message> inbox, std::vector<Message>& outbox) {
    const Time end = std::min(until, options_.from->time);
    const auto first = before(end, inbox);
    const bool differed = !difference_.empty();
    compare(end, first);
    if (!difference_.empty() && !differed && options_.fall_back) {
        execute_until_now(outbox);
        live(end, first, outbox);
    } else {
        send_before(end, outbox);
        granted_ = end;
        if (end == options_.from->time && !take_over(outbox)) execute_until_now(outbox);
    }
    if (until > end) live(until, inbox, outbox);
}

/// Against what the saved board received up to `until`; of differences the first counts.
void ResumedNode::compare(Time until, std::span<const Message> inbox) {
    const std::vector<Message>& expected = options_.from->received;
    for (const Message& message : inbox) {
        if (!difference_.empty()) return;
        if (next_received_ == expected.size() || message.time < expected[next_received_].time)
            return note_difference(message.time, message.port, "received what the saved board did not");
        const Message& saved = expected[next_received_];
        if (saved.time < message.time)
            return note_difference(saved.time, saved.port, "did not receive what the saved board received");
        if (!(saved == message))
            return note_difference(message.time, message.port, "received something else");
        ++next_received_;
    }
    if (difference_.empty() && next_received_ < expected.size() && expected[next_received_].time < until)
        note_difference(expected[next_received_].time, expected[next_received_].port,
                        "did not receive what the saved board received");
}

void ResumedNode::note_difference(Time time, PortIndex port, const std::string& what) {
    const std::string name = port < ports().size() ? ports()[port].name : fmt::format("{}", port);
    difference_ = fmt::format("{} on port {} at {:.6f} s", what, name, to_seconds(time));
}

/// Port by port in order of time, which is the order in which they were saved.
void ResumedNode::send_before(Time until, std::vector<Message>& outbox) {
    const std::vector<Message>& sent = options_.from->sent;
    for (; next_sent_ < sent.size() && sent[next_sent_].time < until; ++next_sent_) {
        outbox.push_back(sent[next_sent_]);
        next_on_port_[sent[next_sent_].port] = after_[next_sent_];
    }
}

/// False if the state does not fit after all: this node then has to be executed.
bool ResumedNode::take_over(std::vector<Message>& outbox) {
    replaying_ = false;
    try {
        StateReader reader(options_.from->memory);
        inner_->state(reader);
        reader.end();
    } catch (const StateError& error) {
        if (!options_.fall_back)
            throw RunError(fmt::format("the state of {} does not fit: {}", name(), error.what()));
        difference_ = fmt::format("the saved state does not fit: {}", error.what());
        return false;
    }
    if (options_.new_random_streams) inner_->renew_random_streams();
    // What the saved board had handed out ahead of its time.
    send_before(kNever, outbox);
    if (options_.fall_back && options_.save_at <= options_.from->time) recording_ = false;
    options_.from->received.clear();
    options_.from->sent.clear();
    options_.from->memory.clear();
    return true;
}

/// From power-up, on what was received: the same as the saved board received before granted_.
void ResumedNode::execute_until_now(std::vector<Message>& outbox) {
    replaying_ = false;
    inner_.reset();
    inner_ = make_();
    if (granted_ == 0) return;
    const std::vector<Message>& received = options_.from->received;
    std::span<const Message> inbox(received);
    std::vector<Message> sent;
    inner_->advance(granted_, before(granted_, inbox), sent);
    // A state that the user gave stands whatever this board would have sent, of other parts perhaps.
    if (!options_.fall_back) return;
    std::stable_sort(sent.begin(), sent.end(), earlier);
    const auto& replayed = options_.from->sent;
    if (sent.size() < next_sent_ ||
        !std::equal(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(next_sent_), replayed.begin()))
        throw RunError("executed again, the board sends something else than the saved state has: run with "
                       "--no-cache");
    outbox.insert(outbox.end(), sent.begin() + static_cast<std::ptrdiff_t>(next_sent_), sent.end());
}

void ResumedNode::hand_out_state() {
    BoardState state;
    state.board = options_.board;
    state.time = options_.save_at;
    state.received = std::move(received_);
    state.sent = std::move(sent_);
    std::stable_sort(state.sent.begin(), state.sent.end(), earlier);
    StateWriter writer(state.memory);
    const StatefulNode& node = *inner_;
    node.state(writer);
    warning_ = options_.save(std::move(state));
    received_.clear();
    sent_.clear();
}

const Message* ResumedNode::next_sent(PortIndex port) const {
    const std::size_t next = next_on_port_[port];
    return next < options_.from->sent.size() ? &options_.from->sent[next] : nullptr;
}

/// What the saved board sent next, as long as nothing but what it received comes in: with `fall_back` that is
/// known up to the next message that it received.
Time ResumedNode::earliest_output(PortIndex port) const {
    if (!replaying_) return inner_->earliest_output(port);
    Time first = options_.from->time;
    if (options_.fall_back && next_received_ < options_.from->received.size())
        // Just behind it: whoever sends it at that very time can only be granted if this node lets it pass.
        first = std::min(first, options_.from->received[next_received_].time + 1);
    if (const Message* next = next_sent(port)) first = std::min(first, next->time);
    return std::max(first, granted_);
}

Time ResumedNode::lookahead(PortIndex port) const {
    if (!replaying_) return inner_->lookahead(port);
    return options_.fall_back ? 0 : kNever;
}

std::optional<Time> ResumedNode::begun(PortIndex port) const {
    if (!replaying_) return inner_->begun(port);
    if (ports()[port].kind != PortKind::Uart) return std::nullopt;
    const Message* next = next_sent(port);
    const auto* frame = next ? std::get_if<UartFrame>(&next->payload) : nullptr;
    if (frame == nullptr || frame->start >= granted_) return std::nullopt;
    return frame->start;
}

std::optional<Stop> ResumedNode::stop() const {
    return replaying_ ? std::nullopt : inner_->stop();
}

std::string ResumedNode::finish() {
    const bool skipped = options_.from && !replaying_ && (difference_.empty() || !options_.fall_back);
    if (replaying_) {
        // The run ended before the saved state began: the report is of what the saved board did by then.
        std::vector<Message> ignored;
        execute_until_now(ignored);
    }
    auto report = nlohmann::ordered_json::parse(inner_->finish());
    if (options_.from) {
        auto& resumed = report["resumed"];
        resumed = {
            {"from", options_.source}, {"at_s", to_seconds(options_.from->time)}, {"skipped", skipped}};
        if (!difference_.empty()) resumed["difference"] = difference_;
        if (!difference_.empty() && !options_.fall_back)
            warning_ = fmt::format("did not live through the first {:.3f} s of this run: it {}",
                                   to_seconds(options_.from->time), difference_);
    }
    if (!warning_.empty()) report["warnings"].push_back(warning_);
    return report.dump();
}

}  // namespace puckloop::cosim
