#include "cosim/remote/node_session.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::cosim {

bool NodeSession::take(std::span<const std::uint8_t> body) {
    switch (protocol::kind_of(body)) {
    case protocol::Kind::Hello:
        hello(body);
        return true;
    case protocol::Kind::Grant: {
        RunAhead& granted = node("granted");
        protocol::read_grant(body, grant_);
        const auto advanced = granted.begin(grant_.reach, grant_.inbox, grant_.echoes, outbox_);
        if (!advanced) return false;
        done(*advanced);
        return true;
    }
    case protocol::Kind::WindUp:
        node("is to end").wind_up(protocol::read_wind_up(body));
        outbox_.clear();
        done({node_->reached(), node_->reached(), 0});
        return true;
    case protocol::Kind::Save:
        protocol::write_state(answer_, node("is to be saved").save());
        return true;
    case protocol::Kind::Load: {
        const protocol::Load load = protocol::read_load(body);
        node("is to be loaded").load(load.time, load.state);
        outbox_.clear();
        done({load.time, load.time, 0});
        return true;
    }
    case protocol::Kind::Finish: {
        const std::string report = node_ ? node_->finish() : "{}";
        node_.reset();
        over_ = true;
        protocol::write_report(answer_, report);
        return true;
    }
    case protocol::Kind::Ready:
    case protocol::Kind::Done:
    case protocol::Kind::State:
    case protocol::Kind::Report:
    case protocol::Kind::Error:
        break;
    }
    throw RunError("the conductor sent what only nodes send");
}

bool NodeSession::resume(bool wait) {
    const auto advanced = node("goes on").resume(wait, outbox_);
    if (!advanced) return false;
    done(*advanced);
    return true;
}

const Bytes& NodeSession::failure(bool input, const std::string& text) {
    protocol::write_error(answer_, {input, text});
    return answer_;
}

void NodeSession::hello(std::span<const std::uint8_t> body) {
    const protocol::Hello hello = protocol::read_hello(body);
    named_(hello.name);  // before the node makes threads, which inherit it
    std::unique_ptr<Node> made = factory_(hello.json);
    if (!made) throw RunError("nothing can make this node");
    protocol::Ready ready;
    ready.ports.assign(made->ports().begin(), made->ports().end());
    node_ = std::make_unique<RunAhead>(std::move(made));
    node_->read_state(ready.state);
    ready.has_state = node_->has_state();
    protocol::write_ready(answer_, ready);
}

void NodeSession::done(const Advanced& advanced) {
    node_->read_state(state_);
    protocol::write_done(answer_, advanced, state_, outbox_);
}

RunAhead& NodeSession::node(const char* what) {
    if (!node_) throw RunError(fmt::format("{} before it was made", what));
    return *node_;
}

}  // namespace puckloop::cosim
