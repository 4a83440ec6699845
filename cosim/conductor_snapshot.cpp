// A run saved, and gone on with from what was saved (cosim/resume/run_snapshot.h).
//
// At the instant of a snapshot all nodes stand there and none has run ahead, as at the end of a run. How
// grants are cut changes nothing in a run, so pausing does not either.

#include "base/error.h"
#include "base/states/archive.h"
#include "cosim/conductor_state.h"
#include "cosim/resume/run_snapshot.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <utility>

namespace puckloop::cosim {

namespace {

/// Nodes that are executed again are granted so much at a time: they report being alive in between.
constexpr Time kStep = kSecond / 4;

std::vector<bool> states_of(const std::vector<std::unique_ptr<NodeHandle>>& handles) {
    std::vector<bool> has_state;
    for (const auto& handle : handles)
        has_state.push_back(handle->has_state());
    return has_state;
}

/// What is kept of a wire and what its sender, executed again, has sent.
class Comparison {
  public:
    explicit Comparison(const SentRecord& then) : then_(then), kept_(then.messages(0)) {}

    /// False: it is not what was sent then.
    bool take(Time delivery, const Payload& payload) {
        now_.add(delivery, payload);
        const std::uint64_t i = now_.count() - 1;
        return now_.count() <= then_.count() &&
               (!then_.keeps() || (kept_[i].time == delivery && kept_[i].payload == payload));
    }
    bool complete() const { return now_.count() == then_.count() && now_.digest() == then_.digest(); }

  private:
    const SentRecord& then_;
    std::vector<Message> kept_;
    SentRecord now_;
};

[[noreturn]] void unlike(const NodeHandle& node, std::string_view port, Time time) {
    throw InputError("", std::string(node.name()),
                     fmt::format("executed again it does not send what it sent when the run was saved (port "
                                 "{}, before {:.6f} s)",
                                 port, to_seconds(time)),
                     "a program that does the same each time, and faults that begin after the snapshot");
}

}  // namespace

void Conductor::State::begin_anew() {
    for (std::size_t n = 0; n < handles_.size(); ++n)
        network_->update(n, handles_[n]->state(), 0, kNever);
    network_->preset(deliveries_, changes_);
    take_deliveries(kNobody);
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        times_[n].runs_ahead = may_run_ahead(n);
        times_[n].horizon = handles_[n]->state().horizon;
    }
}

void Conductor::State::keep_record() {
    network_->keep_record(states_of(handles_));
}

/// To the end, with a snapshot at each instant asked for that comes before it.
void Conductor::State::run_and_save() {
    const Time begin = options_.from ? options_.from->time : 0;
    const auto next = [&](Time after) { return std::min(next_save(after), next_stand(after)); };
    for (Time at = next(begin), before = begin; at != kNever; before = std::exchange(at, next(at))) {
        pause_ = at;
        loop();
        if (end_ < at) break;
        finish_trace();
        release_trace(at);
        for (TraceSink* sink : sinks)
            sink->flush();
        if (at == next_save(before)) {
            RunSnapshot taken = snapshot(at);
            options_.save(taken);
        }
        if (at == next_stand(before)) options_.stand(at, [&] { return snapshot(at); });
    }
    pause_ = kNever;  // nor does one that is due while nodes end hold them back
    loop();
}

Time Conductor::State::next_save(Time after) const {
    const auto listed = std::upper_bound(options_.save_at.begin(), options_.save_at.end(), after);
    const Time next = listed == options_.save_at.end() ? kNever : *listed;
    return options_.save_next ? std::min(next, options_.save_next(after)) : next;
}

Time Conductor::State::next_stand(Time after) const {
    return options_.stand_next ? options_.stand_next(after) : kNever;
}

RunSnapshot Conductor::State::snapshot(Time time) {
    RunSnapshot snapshot;
    snapshot.time = time;
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        NodeHandle& node = *handles_[n];
        current_ = n;
        snapshot.nodes.push_back({std::string(node.name()), node.has_state(), {}, slots_[n].stop_seen});
        if (node.has_state()) snapshot.nodes.back().state = node.save();
    }
    current_ = kNobody;
    snapshot.wires = network_->save();
    snapshot.stats = stats_;
    snapshot.in_flight = merger_.records();
    std::sort(snapshot.in_flight.begin(), snapshot.in_flight.end(),
              [](const TraceRecord& a, const TraceRecord& b) { return a.key() < b.key(); });
    snapshot.hash = hash_.save();
    for (const auto& [stop, node] : stop_requests_)
        snapshot.stop_requests.push_back({stop, static_cast<std::uint32_t>(node)});
    if (stop_) snapshot.stop = {*stop_, static_cast<std::uint32_t>(stop_requester_)};
    snapshot.unlinked = network_->unlinked();
    return snapshot;
}

void Conductor::State::go_on_from(const RunSnapshot& from) {
    const auto begin = WallClock::now();
    const Time time = from.time;
    std::vector<bool> had_state;
    if (from.nodes.size() != handles_.size()) throw InputError("", "nodes", "another number of nodes");
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        if (from.nodes[n].name != handles_[n]->name() || from.nodes[n].has_state != handles_[n]->has_state())
            throw InputError("", std::string(handles_[n]->name()), "is another kind of node than was saved");
        had_state.push_back(from.nodes[n].has_state);
    }
    if (end_ < time)
        throw InputError("", "duration", fmt::format("ends before the snapshot, {:g} s", to_seconds(time)));
    Network::Restored restored;
    try {
        restored = network_->restore(from.wires, from.in_flight, time, had_state, from.unlinked);
        hash_.load(from.hash);
    } catch (const StateError& error) {
        throw InputError("", "trace", error.what());
    } catch (const CodecError& error) {
        throw InputError("", "links", error.what());
    }
    stats_ = from.stats;
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        current_ = n;
        if (had_state[n]) handles_[n]->load(time, from.nodes[n].state);
    }
    execute_again(from, restored.arrived);
    for (std::size_t n = 0; n < handles_.size(); ++n) {
        NodeTimes& node = times_[n];
        node.granted = node.ahead = slots_[n].asked = slots_[n].asked_ahead = time;
        network_->update(n, handles_[n]->state(), time, kNever);
        node.runs_ahead = may_run_ahead(n);
        node.horizon = handles_[n]->state().horizon;
    }
    deliveries_ = std::move(restored.in_flight);
    take_deliveries(kNobody);
    take_stops(from);
    went_on_ = true;
    restored_s_ = seconds_since(begin);
}

/// The nodes without a state, all at a time, each by itself.
void Conductor::State::execute_again(const RunSnapshot& from, const std::vector<TraceRecord>& arrived) {
    std::vector<std::size_t> nodes;
    std::vector<std::vector<Message>> received(handles_.size());
    std::vector<std::size_t> taken(handles_.size());
    std::vector<std::optional<Comparison>> sent(network_->wire_count());
    for (std::size_t n = 0; n < handles_.size(); ++n)
        if (!handles_[n]->has_state()) nodes.push_back(n);
    for (const TraceRecord& record : arrived) {
        const Wire& wire = network_->wire(record);
        received[wire.to].push_back({record.time, wire.to_port, record.payload});
    }
    for (Time until = 0; until < from.time;) {
        until = std::min(from.time, until + kStep);
        for (const std::size_t n : nodes) {
            std::vector<Message>& inbox = slots_[n].inbox;
            inbox.clear();
            for (std::size_t& i = taken[n]; i < received[n].size() && received[n][i].time < until; ++i)
                inbox.push_back(received[n][i]);
            current_ = n;
            handles_[n]->grant({until, until, until}, inbox, {});
        }
        for (const std::size_t n : nodes) {
            current_ = n;
            while (!handles_[n]->poll(true)) {
            }
            if (specs_[n].outside) continue;
            for (const Message& message : handles_[n]->outbox()) {
                const std::size_t w = network_->wire_of(n, message.port);
                if (w == kNobody) continue;
                if (!sent[w]) sent[w].emplace(from.wires[w].sent);
                if (!sent[w]->take(network_->delivery(w, message), message.payload))
                    unlike(*handles_[n], handles_[n]->ports()[message.port].name, until);
            }
        }
    }
    for (const std::size_t n : nodes)
        for (std::size_t p = 0; p < handles_[n]->ports().size(); ++p) {
            const std::size_t w = network_->wire_of(n, static_cast<PortIndex>(p));
            if (w == kNobody || specs_[n].outside) continue;
            if (sent[w] ? !sent[w]->complete() : from.wires[w].sent.count() != 0)
                unlike(*handles_[n], handles_[n]->ports()[p].name, from.time);
        }
    current_ = kNobody;
}

/// Wishes to end the run that were heard before.
void Conductor::State::take_stops(const RunSnapshot& from) {
    for (std::size_t n = 0; n < handles_.size(); ++n)
        slots_[n].stop_seen = from.nodes[n].stop_seen;
    for (const StopSnapshot& request : from.stop_requests)
        stop_requests_.emplace_back(request.stop, request.node);
    if (from.stop) end_with(from.stop->stop, from.stop->node);
}

}  // namespace puckloop::cosim
