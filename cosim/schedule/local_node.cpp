// A node in the conductor's own process: grants are plain calls.

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/schedule/node_handle.h"
#include "cosim/schedule/run_ahead.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

namespace puckloop::cosim {

void read_state(const Node& node, NodeState& state) {
    const std::size_t count = node.ports().size();
    state.ports.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto port = static_cast<PortIndex>(i);
        state.ports[i] = {node.earliest_output(port), node.lookahead(port), node.begun(port)};
    }
    state.stop = node.stop();
    state.wound_up = node.wound_up();
    state.runs_ahead = false;
    state.bounded = false;
    state.horizon = kNever;
}

namespace {

class LocalNode : public NodeHandle {
  public:
    LocalNode(const std::string& name, const std::string& json, const NodeFactory& factory)
        : LocalNode(name, factory(json)) {}
    LocalNode(const std::string& name, std::unique_ptr<Node> node) {
        name_ = name;
        if (!node) throw RunError(fmt::format("node {}: nothing can make it", name_));
        ports_.assign(node->ports().begin(), node->ports().end());
        suspendable_ = node->suspendable() != nullptr;
        node_ = std::make_unique<RunAhead>(std::move(node));
        node_->read_state(state_);
        has_state_ = node_->has_state();
        if (node_->sampling()) read_sampling(*node_->sampling());
    }

    void await_ready() override {}

    void grant(Reach reach, const std::vector<Message>& inbox, std::span<const PortEcho> echoes) override {
        reach_ = reach;
        inbox_ = &inbox;
        echoes_ = echoes;
        begun_ = false;
    }

    bool poll(bool wait) override {
        std::optional<Advanced> done;
        guarded("stopped", [&] {
            done = begun_ ? node_->resume(wait, outbox_) : node_->begin(reach_, *inbox_, echoes_, outbox_);
        });
        begun_ = true;
        if (!done) return false;
        advanced_ = *done;
        node_->read_state(state_);
        return true;
    }

    bool advance(Time until, const std::vector<Message>& inbox) override {
        if (suspendable_) return NodeHandle::advance(until, inbox);
        guarded("stopped", [&] { node_->advance_to(until, inbox, outbox_); });
        read_linked();
        return true;
    }

    void advance_sampling(const SampledReach& reach, const std::vector<Message>& inbox) override {
        guarded("stopped", [&] { node_->advance_sampling(reach, inbox, outbox_); });
        read_linked();
        if (turn_port_) has_turn_ = node_->sampling()->has_turn();
    }

    void wind_up(int signal) override {
        guarded("could not wind up", [&] { node_->wind_up(signal); });
        node_->read_state(state_);
    }

    std::vector<std::uint8_t> save() override {
        std::vector<std::uint8_t> state;
        guarded("could not be saved", [&] { state = node_->save(); });
        return state;
    }

    void load(Time time, const std::vector<std::uint8_t>& state) override {
        guarded("could not be loaded", [&] { node_->load(time, state); });
        advanced_ = {time, time, 0};
        node_->read_state(state_);
    }

    WorkCounts work() const override { return node_ ? node_->work() : WorkCounts{}; }

    std::string finish() override {
        std::string report;
        guarded("could not finish", [&] { report = node_->finish(); });
        node_.reset();
        return report;
    }

  private:
    void read_sampling(const SampledInputs& sampling) {
        turn_port_ = sampling.turn_port();
        for (std::size_t port = 0; port < ports_.size(); ++port) {
            sampled_.push_back(sampling.sampled(static_cast<PortIndex>(port)));
            independent_.push_back(sampling.independent(static_cast<PortIndex>(port)));
        }
        if (!turn_port_ && std::find(sampled_.begin(), sampled_.end(), true) == sampled_.end())
            sampled_.clear();
    }
    /// After the node went straight to where it now is.
    void read_linked() {
        const Node& node = node_->node();
        advanced_ = {node_->reached(), node_->reached(), outbox_.size()};
        for (const PortIndex port : linked_) {
            PortState& state = state_.ports[port];
            state.earliest_output = node.earliest_output(port);
            state.lookahead = node.lookahead(port);
            if (ports_[port].kind == PortKind::Uart) state.begun = node.begun(port);
        }
        state_.stop = node.stop();
        state_.wound_up = node.wound_up();
        state_.runs_ahead = node_->can_go_back();
    }

    template <typename Work>
    void guarded(const char* what, Work work) {
        try {
            work();
        } catch (const InputError&) {
            throw;
        } catch (const std::exception& error) {
            throw RunError(fmt::format("node {} {} at simulated time {:.9f} s: {}", name_, what,
                                       to_seconds(reached()), reason_of(error)));
        }
    }

    std::unique_ptr<RunAhead> node_;
    const std::vector<Message>* inbox_ = nullptr;
    std::span<const PortEcho> echoes_;
    Reach reach_;
    bool begun_ = false;        ///< the work of the grant
    bool suspendable_ = false;  ///< the node (Suspendable)
};

}  // namespace

std::unique_ptr<NodeHandle> make_local_node(const std::string& name, const std::string& json,
                                            const NodeFactory& factory) {
    return std::make_unique<LocalNode>(name, json, factory);
}

}  // namespace puckloop::cosim
