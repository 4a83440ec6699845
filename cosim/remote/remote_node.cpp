#include "cosim/remote/remote_node.h"

#include "base/error.h"
#include "cosim/remote/protocol.h"

#include <fmt/format.h>

#include <chrono>

namespace puckloop::cosim {

namespace {

// A node under grant when the run ends gets so long to come back.
constexpr std::chrono::seconds kFinishPatience{2};

class RemoteNode : public NodeHandle {
  public:
    RemoteNode(std::unique_ptr<NodeLine> line, const std::string& name, const std::string& json,
               double stall_seconds)
        : line_(std::move(line)),
          stall_(std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(stall_seconds))) {
        name_ = name;
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
            has_state_ = ready.has_state;
        });
    }

    void grant(Reach reach, const std::vector<Message>& inbox, std::span<const PortEcho> echoes) override {
        asked_ = reach.until;
        busy_ = true;
        protocol::write_grant(bytes_, reach, inbox, echoes);
        send();
    }

    bool poll(bool wait) override {
        if (!receive(wait)) return false;
        decode(protocol::Kind::Done, [&](auto body) {
            const Advanced done = protocol::read_done(body, ports_.size(), state_, outbox_);
            if (done.reached < reached() || done.reached > asked_)
                throw CodecError("a time that was not granted");
            advanced_ = done;
        });
        busy_ = false;
        return true;
    }

    bool elsewhere() const override { return true; }
    int process() const override { return line_->process(); }

    void wind_up(int signal) override {
        protocol::write_wind_up(bytes_, signal);
        send();
        while (!receive(true)) {
        }
        decode(protocol::Kind::Done, [&](auto body) {
            if (protocol::read_done(body, ports_.size(), state_, outbox_).reached != reached() ||
                !outbox_.empty())
                throw CodecError("more than it was asked for");
        });
    }

    std::vector<std::uint8_t> save() override {
        protocol::write_save(bytes_);
        send();
        while (!receive(true)) {
        }
        Bytes state;
        decode(protocol::Kind::State, [&](auto body) { state = protocol::read_state(body); });
        return state;
    }

    void load(Time time, const std::vector<std::uint8_t>& state) override {
        protocol::write_load(bytes_, time, state);
        send();
        while (!receive(true)) {
        }
        decode(protocol::Kind::Done, [&](auto body) {
            const Advanced done = protocol::read_done(body, ports_.size(), state_, outbox_);
            if (done.reached != time || done.ahead != time || !outbox_.empty())
                throw CodecError("another time than the one it was loaded at");
            advanced_ = done;
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
        line_->close();
        return report;
    }

  private:
    void send() {
        asked_at_ = Clock::now();
        try {
            for (bool dead = line_->ended(); !line_->send(bytes_, kWaitSlice); dead = line_->ended()) {
                if (dead) ended();
                if (Clock::now() - asked_at_ > stall_) lose("does not take what is sent to it");
            }
        } catch (const CodecError& error) {
            lose(fmt::format("sent {}", error.what()));
        }
    }

    /// True when a whole message has come; throws when the node will not answer any more.
    bool receive(bool wait) {
        const bool dead = line_->ended();
        try {
            if (line_->receive(wait && !dead ? kWaitSlice : kWaitSlice.zero())) return true;
        } catch (const CodecError& error) {
            lose(fmt::format("sent {}", error.what()));
        }
        if (dead) ended();
        const auto waited = Clock::now() - asked_at_;
        if (waited > stall_)
            lose(fmt::format("has not answered for {:.1f} s of wall time (--stall)",
                             std::chrono::duration<double>(waited).count()));
        return false;
    }

    template <typename Read>
    void decode(protocol::Kind expected, Read read) {
        const auto body = line_->body();
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
                                   to_seconds(reached()), error.text));
    }

    [[noreturn]] void ended() { lose(line_->ending()); }

    [[noreturn]] void lose(const std::string& cause) {
        lost_ = true;
        const std::string granted =
            busy_ ? fmt::format(" (granted to {:.9f} s)", to_seconds(asked_)) : std::string();
        throw RunError(fmt::format("node {} ({}) {}; last simulated time {:.9f} s{}", name_, line_->place(),
                                   cause, to_seconds(reached()), granted));
    }

    std::unique_ptr<NodeLine> line_;
    Bytes bytes_;
    Clock::duration stall_;
    Clock::time_point asked_at_{};
    Time asked_ = 0;
    bool busy_ = false;
    bool lost_ = false;  ///< nothing more is to be expected from it
};

}  // namespace

std::unique_ptr<NodeHandle> make_remote_node(std::unique_ptr<NodeLine> line, const std::string& name,
                                             const std::string& json, double stall_seconds) {
    return std::make_unique<RemoteNode>(std::move(line), name, json, stall_seconds);
}

}  // namespace puckloop::cosim
