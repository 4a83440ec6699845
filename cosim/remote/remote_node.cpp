#include "cosim/remote/remote_node.h"

#include "base/error.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/child_process.h"
#include "cosim/remote/protocol.h"
#include "cosim/remote/socket_stream.h"

#include <fmt/format.h>

#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <cstring>

namespace puckloop::cosim {

namespace {

// How often a wait looks at the clock and at Ctrl-C.
constexpr std::chrono::milliseconds kWaitSlice{100};
// A process whose socket closed is about to end; after that it is killed.
constexpr std::chrono::milliseconds kEndPatience{2000};
// A node under grant when the run ends gets so long to come back.
constexpr std::chrono::seconds kFinishPatience{2};

class RemoteNode : public NodeHandle {
  public:
    RemoteNode(const std::string& name, const std::string& json, const std::vector<std::string>& command,
               double stall_seconds)
        : stall_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(stall_seconds))) {
        name_ = name;
        int ends[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
            throw RunError(fmt::format("node {}: no socket: {}", name_, std::strerror(errno)));
        stream_ = std::make_unique<SocketStream>(ends[0]);
        SocketStream other(ends[1]);  // closed here once the child has it
        stream_->set_timeout(kWaitSlice);
        child_ = std::make_unique<ChildProcess>(command, std::string(kNodeTitle) + name_, ends[1]);
        protocol::write_hello(bytes_, {name, json});
        send();
    }

    void await_ready() override {
        while (!receive(true)) {
        }
        decode(protocol::Kind::Ready, [&](auto body) {
            protocol::Ready ready = protocol::read_ready(body);
            ports_ = std::move(ready.ports);
            state_ = std::move(ready.state);
        });
    }

    void grant(Reach reach, const std::vector<Message>& inbox, const std::vector<PortEcho>& echoes) override {
        asked_ = reach.until;
        busy_ = true;
        protocol::write_grant(bytes_, reach, inbox, echoes);
        send();
    }

    bool poll(bool wait) override {
        if (!receive(wait)) return false;
        decode(protocol::Kind::Done, [&](auto body) {
            const Time reached = protocol::read_done(body, ports_.size(), state_, outbox_);
            if (reached <= reached_ || reached > asked_) throw CodecError("a time that was not granted");
            reached_ = reached;
        });
        busy_ = false;
        return true;
    }

    int descriptor() const override { return stream_->descriptor(); }
    int process() const override { return static_cast<int>(child_->id()); }

    void wind_up(int signal) override {
        protocol::write_wind_up(bytes_, signal);
        send();
        while (!receive(true)) {
        }
        decode(protocol::Kind::Done, [&](auto body) {
            if (protocol::read_done(body, ports_.size(), state_, outbox_) != reached_ || !outbox_.empty())
                throw CodecError("more than it was asked for");
        });
    }

    std::string finish() override {
        if (lost_) return {};
        const auto patience = std::min<Clock::duration>(stall_, kFinishPatience);
        if (busy_) {
            stall_ = patience;
            asked_at_ = Clock::now();
            while (!poll(true)) {
            }
        }
        protocol::write_finish(bytes_);
        send();
        while (!receive(true)) {
        }
        std::string report;
        decode(protocol::Kind::Report, [&](auto body) { report = protocol::read_report(body); });
        lost_ = true;
        child_->ended(kEndPatience);
        return report;
    }

  private:
    void send() {
        asked_at_ = Clock::now();
        try {
            if (!stream_->send(bytes_, asked_at_ + stall_)) ended();
        } catch (const CodecError& error) {
            lose(error.what());
        }
    }

    /// True when a whole message has come; throws when the node will not answer any more.
    bool receive(bool wait) {
        SocketStream::Status status{};
        try {
            status = stream_->receive(wait);
        } catch (const CodecError& error) {
            lose(fmt::format("sent {}", error.what()));
        }
        if (status == SocketStream::Status::Closed) ended();
        if (status == SocketStream::Status::Whole) return true;
        const auto waited = Clock::now() - asked_at_;
        if (waited > stall_)
            lose(fmt::format("has not answered for {:.1f} s of wall time (--stall)",
                             std::chrono::duration<double>(waited).count()));
        return false;
    }

    template <typename Read>
    void decode(protocol::Kind expected, Read read) {
        const auto body = stream_->body();
        protocol::Error error;
        try {
            if (protocol::kind_of(body) != protocol::Kind::Error) {
                if (protocol::kind_of(body) != expected) throw CodecError("message of the wrong kind");
                read(body);
                return;
            }
            error = protocol::read_error(body);
        } catch (const CodecError& damage) {
            lose(fmt::format("sent a damaged message: {}", damage.what()));
        }
        lost_ = true;
        if (error.input) throw InputError("", "", error.text);
        throw RunError(fmt::format("node {} stopped at simulated time {:.9f} s: {}", name_,
                                   to_seconds(reached_), error.text));
    }

    [[noreturn]] void ended() {
        child_->ended(kEndPatience);
        lose(child_->ending());
    }

    [[noreturn]] void lose(const std::string& cause) {
        lost_ = true;
        const std::string granted =
            busy_ ? fmt::format(" (granted to {:.9f} s)", to_seconds(asked_)) : std::string();
        throw RunError(fmt::format("node {} (process {}) {}; last simulated time {:.9f} s{}", name_,
                                   child_->id(), cause, to_seconds(reached_), granted));
    }

    std::unique_ptr<SocketStream> stream_;
    std::unique_ptr<ChildProcess> child_;
    Bytes bytes_;
    Clock::duration stall_;
    Clock::time_point asked_at_{};
    Time asked_ = 0;
    bool busy_ = false;
    bool lost_ = false;  ///< nothing more is to be expected from it
};

}  // namespace

std::unique_ptr<NodeHandle> make_remote_node(const std::string& name, const std::string& json,
                                             const std::vector<std::string>& command, double stall_seconds) {
    return std::make_unique<RemoteNode>(name, json, command, stall_seconds);
}

void await_any(const std::vector<std::unique_ptr<NodeHandle>>& nodes, const std::vector<std::size_t>& which) {
    std::vector<pollfd> waits;
    for (const std::size_t n : which)
        waits.push_back({nodes[n]->descriptor(), POLLIN, 0});
    ::poll(waits.data(), waits.size(), static_cast<int>(kWaitSlice.count()));
}

}  // namespace puckloop::cosim
