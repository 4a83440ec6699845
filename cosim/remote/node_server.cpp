#include "cosim/remote/node_server.h"

#include "base/error.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/protocol.h"
#include "cosim/remote/socket_stream.h"

#include <exception>

#include <fcntl.h>

namespace puckloop::cosim {

namespace {

class Server {
  public:
    Server(int descriptor, const NodeFactory& factory) : stream_(descriptor), factory_(factory) {}

    int serve() {
        try {
            while (true) {
                const SocketStream::Status status = stream_.receive(true);
                if (status == SocketStream::Status::Closed) return 1;   // the conductor is gone
                if (status == SocketStream::Status::Partial) continue;  // a signal came between
                if (!answer()) return 0;
                if (!stream_.send(bytes_)) return 1;
            }
        } catch (const InputError& error) {
            return tell({true, error.what()});
        } catch (const std::exception& error) {
            return tell({false, error.what()});
        }
    }

  private:
    /// Writes the answer to the message at hand; false when there is nothing more to do.
    bool answer() {
        const auto body = stream_.body();
        switch (protocol::kind_of(body)) {
        case protocol::Kind::Hello:
            hello(body);
            return true;
        case protocol::Kind::Grant:
            grant(body);
            return true;
        case protocol::Kind::WindUp:
            wind_up(body);
            return true;
        case protocol::Kind::Finish:
            finish();
            return false;
        case protocol::Kind::Ready:
        case protocol::Kind::Done:
        case protocol::Kind::Report:
        case protocol::Kind::Error:
            break;
        }
        throw RunError("the conductor sent what only nodes send");
    }

    void hello(std::span<const std::uint8_t> body) {
        const protocol::Hello hello = protocol::read_hello(body);
        name_thread(hello.name);  // before the node makes threads, which inherit it
        node_ = factory_(hello.json);
        if (!node_) throw RunError("nothing can make this node");
        protocol::Ready ready;
        ready.ports.assign(node_->ports().begin(), node_->ports().end());
        read_state(*node_, ready.state);
        protocol::write_ready(bytes_, ready);
    }

    void grant(std::span<const std::uint8_t> body) {
        if (!node_) throw RunError("granted before it was made");
        protocol::read_grant(body, grant_);
        outbox_.clear();
        reached_ = advance_in_strides(*node_, reached_, grant_.reach, grant_.inbox, grant_.echoes, outbox_);
        read_state(*node_, state_);
        protocol::write_done(bytes_, reached_, state_, outbox_);
    }

    void wind_up(std::span<const std::uint8_t> body) {
        if (!node_) throw RunError("is to end before it was made");
        node_->wind_up(reached_, protocol::read_wind_up(body));
        outbox_.clear();
        read_state(*node_, state_);
        protocol::write_done(bytes_, reached_, state_, outbox_);
    }

    void finish() {
        const std::string report = node_ ? node_->finish() : "{}";
        node_.reset();
        protocol::write_report(bytes_, report);
        stream_.send(bytes_);
    }

    int tell(const protocol::Error& error) {
        protocol::write_error(bytes_, error);
        stream_.send(bytes_);
        return 1;
    }

    SocketStream stream_;
    const NodeFactory& factory_;
    std::unique_ptr<Node> node_;
    protocol::Grant grant_;
    Time reached_ = 0;
    NodeState state_;
    std::vector<Message> outbox_;
    Bytes bytes_;
};

}  // namespace

int serve_node(int descriptor, const NodeFactory& factory) {
    // Programs that the node starts have no business with the conductor.
    fcntl(descriptor, F_SETFD, FD_CLOEXEC);
    return Server(descriptor, factory).serve();
}

}  // namespace puckloop::cosim
