#include "cosim/remote/processes/node_server.h"

#include "base/error.h"
#include "base/plain_text.h"
#include "cosim/core/process_name.h"
#include "cosim/remote/node_session.h"
#include "cosim/remote/processes/node_processes.h"
#include "cosim/remote/processes/ring_stream.h"

#include <exception>

#include <unistd.h>

namespace puckloop::cosim {

namespace {

// How often a wait looks whether the conductor is still there; the kernel should have said so long before.
constexpr std::chrono::seconds kParentSlice{1};

class Server {
  public:
    Server(SharedByRun& run, SharedWithNode& mine, const NodeFactory& factory)
        : cores_(run.busy),
          bell_(mine.node, run.busy),
          conductor_bell_(run.conductor, run.busy),
          stream_(mine.to_node, mine.from_node, bell_, conductor_bell_),
          session_(factory, name_thread) {}

    int serve() {
        try {
            while (!session_.over()) {
                while (!stream_.receive(kParentSlice))
                    if (abandoned()) return 1;
                cores_.follow();
                if (!session_.take(stream_.body()))
                    while (!session_.resume(true)) {
                    }
                send(session_.answer());
            }
            return 0;
        } catch (const InputError& error) {
            return report_error(true, error.what());
        } catch (const std::exception& error) {
            return report_error(false, reason_of(error));
        }
    }

  private:
    void send(const Bytes& message) {
        while (!stream_.send(message, kParentSlice) && !abandoned()) {
        }
    }

    bool abandoned() const { return getppid() != conductor_; }

    int report_error(bool input, const std::string& text) {
        try {
            send(session_.failure(input, text));
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
    NodeSession session_;
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
