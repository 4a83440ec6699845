#include "cosim/remote/node_server.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/node_processes.h"
#include "cosim/remote/protocol.h"
#include "cosim/remote/ring_stream.h"
#include "cosim/schedule/run_ahead.h"

#include <exception>

#include <unistd.h>

namespace puckloop::cosim {

namespace {

// How often a wait looks whether the conductor is still there; the kernel should have said so long before.
constexpr std::chrono::seconds kWaitSlice{1};

class Server {
  public:
    Server(SharedByRun& run, SharedWithNode& mine, const NodeFactory& factory)
        : cores_(run.busy),
          bell_(mine.node, run.busy),
          conductor_bell_(run.conductor, run.busy),
          stream_(mine.to_node, mine.from_node, bell_, conductor_bell_),
          factory_(factory) {}

    int serve() {
        try {
            while (true) {
                while (!stream_.receive(kWaitSlice))
                    if (abandoned()) return 1;
                cores_.follow();
                if (!answer()) return 0;
                send();
            }
        } catch (const InputError& error) {
            return report_error({true, error.what()});
        } catch (const std::exception& error) {
            return report_error({false, reason_of(error)});
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
        case protocol::Kind::Save:
            save();
            return true;
        case protocol::Kind::Load:
            load(body);
            return true;
        case protocol::Kind::Finish:
            finish();
            return false;
        case protocol::Kind::Ready:
        case protocol::Kind::Done:
        case protocol::Kind::State:
        case protocol::Kind::Report:
        case protocol::Kind::Error:
            break;
        }
        throw RunError("the conductor sent what only nodes send");
    }

    void hello(std::span<const std::uint8_t> body) {
        const protocol::Hello hello = protocol::read_hello(body);
        name_thread(hello.name);  // before the node makes threads, which inherit it
        std::unique_ptr<Node> node = factory_(hello.json);
        if (!node) throw RunError("nothing can make this node");
        protocol::Ready ready;
        ready.ports.assign(node->ports().begin(), node->ports().end());
        node_ = std::make_unique<RunAhead>(std::move(node));
        node_->read_state(ready.state);
        ready.has_state = node_->has_state();
        protocol::write_ready(bytes_, ready);
    }

    void grant(std::span<const std::uint8_t> body) {
        if (!node_) throw RunError("granted before it was made");
        protocol::read_grant(body, grant_);
        advanced_ = node_->advance(grant_.reach, grant_.inbox, grant_.echoes, outbox_);
        node_->read_state(state_);
        protocol::write_done(bytes_, advanced_, state_, outbox_);
    }

    void wind_up(std::span<const std::uint8_t> body) {
        if (!node_) throw RunError("is to end before it was made");
        node_->wind_up(protocol::read_wind_up(body));
        outbox_.clear();
        advanced_.sure = 0;
        node_->read_state(state_);
        protocol::write_done(bytes_, advanced_, state_, outbox_);
    }

    void save() {
        if (!node_) throw RunError("is to be saved before it was made");
        protocol::write_state(bytes_, node_->save());
    }

    void load(std::span<const std::uint8_t> body) {
        if (!node_) throw RunError("is to be loaded before it was made");
        const protocol::Load load = protocol::read_load(body);
        node_->load(load.time, load.state);
        outbox_.clear();
        advanced_ = {load.time, load.time, 0};
        node_->read_state(state_);
        protocol::write_done(bytes_, advanced_, state_, outbox_);
    }

    void finish() {
        const std::string report = node_ ? node_->finish() : "{}";
        node_.reset();
        protocol::write_report(bytes_, report);
        send();
    }

    void send() {
        while (!stream_.send(bytes_, kWaitSlice) && !abandoned()) {
        }
    }

    bool abandoned() const { return getppid() != conductor_; }

    int report_error(const protocol::Error& error) {
        protocol::write_error(bytes_, error);
        try {
            send();
        } catch (const CodecError&) {
            // The ring itself is damaged: the exit status has to do.
        }
        return 1;
    }

    const pid_t conductor_ = getppid();
    CoreFollower cores_;
    Bell bell_;
    Bell conductor_bell_;
    RingStream stream_;
    const NodeFactory& factory_;
    std::unique_ptr<RunAhead> node_;
    protocol::Grant grant_;
    Advanced advanced_;
    NodeState state_;
    std::vector<Message> outbox_;
    Bytes bytes_;
};

}  // namespace

int serve_node(int descriptor, const NodeFactory& factory) {
    try {
        const SharedMemory mine(descriptor, sizeof(SharedWithNode));
        const SharedMemory run(descriptor + 1, sizeof(SharedByRun));
        return Server(*reinterpret_cast<SharedByRun*>(run.data()),
                      *reinterpret_cast<SharedWithNode*>(mine.data()), factory)
            .serve();
    } catch (const RunError&) {
        return 1;  // no conductor started this process
    }
}

}  // namespace puckloop::cosim
