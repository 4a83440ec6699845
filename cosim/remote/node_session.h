#pragma once
// The other end of a remote node: the node itself, and its answers to what the conductor asks.

#include "cosim/remote/protocol.h"
#include "cosim/schedule/node_handle.h"
#include "cosim/schedule/run_ahead.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace puckloop::cosim {

class NodeSession {
  public:
    /// Makes the node with `factory`, which outlives the session, once it has its description. `named` is
    /// called before with the node's name.
    NodeSession(const NodeFactory& factory, std::function<void(const std::string&)> named)
        : factory_(factory), named_(std::move(named)) {}

    /// Takes the body of a message. True: answer() is the answer to it; false: the node waits for its program
    /// (Suspendable), and resume() goes on. Throws what the node throws, and RunError and CodecError for what
    /// a conductor does not say.
    bool take(std::span<const std::uint8_t> body);
    /// `wait`: lets the node wait for some milliseconds.
    bool resume(bool wait);
    /// A whole message, length included.
    const Bytes& answer() const { return answer_; }
    /// It has given its report, and is no more.
    bool over() const { return over_; }
    /// In place of an answer.
    const Bytes& failure(bool input, const std::string& text);

  private:
    void hello(std::span<const std::uint8_t> body);
    void done(const Advanced& advanced);
    RunAhead& node(const char* what);

    const NodeFactory& factory_;
    std::function<void(const std::string&)> named_;
    std::unique_ptr<RunAhead> node_;
    protocol::Grant grant_;
    NodeState state_;
    std::vector<Message> outbox_;
    Bytes answer_;
    bool over_ = false;
};

}  // namespace puckloop::cosim
