#pragma once
// A Linux program as a node: port `uart` is its serial port, port `i2c` its I2C adapter; port `camera`, if
// the board has cameras, brings the signals that say what they see (Scenery); port `network`, if it is on
// one, its packets.
//
// The program runs on its own only between two requests, and then only up to the limit of the last reply;
// what it may see is fixed by the simulated time of each request, so its behaviour does not depend on how
// grants are cut. Of several processes the one that is earliest runs (of those at the same time the oldest),
// and only until another one or a device is due: so they meet in pipes, files and signals in the order of
// simulated time.
//
// Deviations: 1. Computing takes no simulated time; each call taken over costs the charge of its class
// (wire::Charges). 2. One thread runs at a time, as on a board with one processor.
// 3. Real-time mode adds the wall clock to the program's time and holds grants back to it.

#include "cosim/core/bounded_rewindable.h"
#include "cosim/core/node.h"
#include "linuxboard/shim/kernel/board_kernel.h"
#include "linuxboard/shim/kernel/linux_faults.h"
#include "linuxboard/shim/kernel/spec.h"
#include "linuxboard/shim/node/launcher.h"
#include "linuxboard/shim/node/process.h"

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::linuxboard {

inline constexpr cosim::PortIndex kUartPort = 0;
inline constexpr cosim::PortIndex kI2cPort = 1;
inline constexpr cosim::PortIndex kCameraPort = 2;  // where there are cameras

class LinuxNode : public cosim::Node, public cosim::Suspendable {
  public:
    /// Checks the program and starts it; it runs only from the first advance on. `scenery`: what the spec's
    /// cameras look at. Throws InputError.
    explicit LinuxNode(LinuxSpec spec, std::unique_ptr<Scenery> scenery = nullptr);

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Suspendable* suspendable() override { return this; }
    bool begin(cosim::Time until, std::span<const cosim::Message> inbox,
               std::vector<cosim::Message>& outbox) override;
    bool resume(bool wait) override;
    cosim::Time earliest_output(cosim::PortIndex port) const override;
    cosim::Time lookahead(cosim::PortIndex port) const override;
    cosim::Rewindable* rewindable() override { return speculation_ ? &*speculation_ : nullptr; }
    std::optional<cosim::Stop> stop() const override { return stop_; }
    /// The program gets `signal`, or the scenario's, and SIGKILL once the grace period is over. One that
    /// would die of the signal without a word does so now.
    void wind_up(cosim::Time now, int signal) override;
    cosim::Time wound_up() const override { return wound_up_; }
    std::string finish() override;

    /// A node from its JSON description (spec.h).
    static std::unique_ptr<LinuxNode> from_json(std::string_view json) {
        return std::make_unique<LinuxNode>(parse_linux_spec(json));
    }

    /// Lines about what the program did that is not supported, each once.
    const std::vector<std::string>& warnings() const { return warnings_; }
    /// Requests the program made so far; without those that the library answered by itself.
    std::uint64_t requests() const { return requests_; }

  private:
    /// While the program waits, the node is its devices, which can go back (linux_node_speculation.cpp).
    class Speculation : public cosim::BoundedRewindable {
      public:
        explicit Speculation(LinuxNode& node) : node_(node) {}
        void mark() override;
        void rewind() override;
        void settle() override { marked_ = false; }
        cosim::Time horizon(std::span<const cosim::Message> next) const override;
        bool marked() const { return marked_; }

      private:
        LinuxNode& node_;
        bool marked_ = false;
        std::optional<BoardKernel::Devices> devices_;  ///< as they were at the mark
        cosim::Time until_ = 0;
        std::uint64_t messages_in_ = 0;
    };

    /// One process of the program.
    struct Client {
        enum class State {
            Starting,  ///< asked for by its parent, has not said Hello
            Running,   ///< on its own, until its next request; one at most, while advance() is under way
            Asking,    ///< `request` has its time and is not yet handled
            Waiting,   ///< all threads wait; a device, `request.wait_until`, a signal or a process goes on
        };
        std::uint32_t slot = 0;
        std::unique_ptr<Process> process;
        State state = State::Starting;
        wire::Request request;
        std::string data;
        std::string inherited;  ///< for its next Hello
        std::vector<FinishedCall> finished;
        std::set<int> handles;      ///< open files of the kernel
        std::uint64_t signals = 0;  ///< to be delivered; bit n: signal n
        cosim::Time signals_at = cosim::kNever;
        /// When another process did what this one may wait for.
        cosim::Time woken_at = cosim::kNever;
        int passed = -1;           ///< descriptor that goes with the next reply
        cosim::Time answered = 0;  ///< when it was last
        bool end_signalled = false;
        bool announced_exit = false;
        bool leaving = false;  ///< it is dead; its last close of the serial port waits for what was written
        cosim::Time exit_time = 0;
    };

    // linux_node.cpp: time and devices
    void start_program();
    /// Lets devices and deliveries happen up to and including `now`, in order.
    void run_devices(cosim::Time now);
    cosim::Time next_scheduled() const;
    void run_scheduled(cosim::Time now);
    void apply_faults(cosim::Time now);
    cosim::Time next_device_event() const;
    cosim::Time next_action() const;
    mutable std::optional<cosim::Time> action_;  ///< next_action() since advance(); asked for by each port
    void collect(std::vector<cosim::Message>& outbox);
    void pace(cosim::Time time);

    // linux_node_speculation.cpp
    bool can_foresee() const;
    /// What follows cannot be taken back.
    void must_be_final() const;

    // linux_node_turns.cpp: the program's turns and the node's
    bool step();
    void handle_request(Client& client);
    void answer(Client& client, cosim::Time now);
    bool listen(Client& client, bool wait);

    // linux_node_ahead.cpp: what the library answers by itself
    /// Sets the limit of `reply`, whose time is set, and shows the serial port.
    void show_ahead(const Client& client, wire::Reply& reply) const;
    /// Does at the devices what the library did by itself since the last reply.
    void catch_up(Client& client);

    // linux_node_family.cpp: the processes among themselves
    wire::ProcessEntry& entry(std::uint32_t slot) { return launcher_->page().processes[slot]; }
    Client* client_at(std::uint32_t slot);
    /// The earliest process in `state`, or nullptr.
    Client* first(Client::State state);
    /// When `client` has something to do, as far as is known.
    static cosim::Time due(const Client& client);
    /// The same, not before the program goes on after a pause.
    cosim::Time goes_on(const Client& client) const { return std::max(due(client), paused_until_); }
    /// Answers a waiting process for which something has happened by `now`; false if there is none.
    bool wake_ready(cosim::Time now);
    void deal_out();
    void finish(Client& client, std::int64_t result, int error = 0, std::string data = {});
    /// True if the request was one about processes.
    bool handle_family(Client& client);
    void fork(Client& client);
    void hear_child(Client& parent);
    void hello(Client& client);
    void send_signal(std::uint32_t slot, int signal, cosim::Time now, const wire::SignalOrigin& origin = {});
    void signal_all(int signal, cosim::Time now);
    void changed(const Client* by, cosim::Time now);
    bool leaves_slowly(Client& client, cosim::Time now);
    void client_ended(Client& client, cosim::Time now);
    void kill_all(cosim::Time now);

    // linux_node_end.cpp: how it ends
    void program_ended(cosim::Time now);
    void first_ended(cosim::Time now);
    void look_at_first(cosim::Time now);
    void notice_first_killed(cosim::Time now);
    std::string with_first_killed(std::string how) const;
    void ended_winding_up(cosim::Time now);
    void out_of_grace(cosim::Time now);
    void end_leaving(cosim::Time now);
    void send_end_signal(cosim::Time now);
    void signalled_ended(cosim::Time now);
    bool used_a_device() const;
    bool has_no_devices() const;
    void note_waiting(cosim::Time now);
    void note_devices();
    void warn(std::string line);
    std::string last_words() const;
    void end_run(cosim::Time now, bool success, std::string reason, std::uint32_t programs);

    LinuxSpec spec_;
    LinuxFaults faults_;
    std::vector<cosim::Port> ports_;
    std::optional<cosim::PortIndex> network_port_;
    std::unique_ptr<Launcher> launcher_;
    std::unique_ptr<Scenery> scenery_;
    BoardKernel kernel_;
    std::vector<std::unique_ptr<Client>> clients_;  ///< by age
    std::int32_t last_number_ = 0;
    cosim::Time until_ = 0;
    cosim::Time begun_ = 0;  ///< of the time that is granted
    std::optional<Speculation> speculation_;
    std::optional<cosim::Time> waking_at_;  ///< instant of the last step: its processes are being woken
    cosim::Time start_at_ = cosim::kNever;
    std::size_t next_restart_ = 0;
    std::size_t next_signal_ = 0;
    std::size_t next_hangup_ = 0;
    int end_signal_ = 0;  ///< the run ends: this one was or will be sent
    cosim::Time end_signal_at_ = cosim::kNever;
    bool end_signal_sent_ = false;  ///< to the processes that handle it
    cosim::Time kill_at_ = cosim::kNever;
    cosim::Time paused_until_ = 0;  ///< by a fault
    cosim::Time wound_up_ = 0;
    bool never_opened_ = false;
    std::vector<cosim::Message> inbox_;
    std::size_t inbox_next_ = 0;
    std::vector<cosim::Message>* outbox_ = nullptr;
    std::optional<cosim::Stop> stop_;
    std::vector<std::string> warnings_;
    std::uint64_t requests_ = 0;
    std::uint64_t answered_by_library_ = 0;
    std::uint64_t starts_ = 0;
    std::uint64_t processes_ = 0;  ///< made in all
    std::uint64_t messages_in_ = 0;
    // Of the program's first process, which is what counts as the program's end.
    std::string end_;
    bool ended_well_ = false;
    bool crashed_ = false;
    int killed_by_ = 0;
    std::string first_killed_;  ///< while others of its processes went on, and when; empty: it was not
    /// When it was noticed that somebody outside of simulated time had killed it.
    std::optional<cosim::Time> first_gone_at_;
    cosim::Time next_look_ = 0;
};

}  // namespace puckloop::linuxboard
