#pragma once
// A Linux program as a node: port `uart` is its serial port, port `i2c` its I2C adapter.
//
// The program runs on its own only between two requests; what it may see is fixed by the simulated time of
// each request, so its behaviour does not depend on how grants are cut.
//
// Deviations: 1. Computing takes no simulated time; each call taken over costs the charge of its class
// (wire::Charges). 2. One thread runs at a time, as on a board with one processor.
// 3. Real-time mode adds the wall clock to the program's time and holds grants back to it.

#include "cosim/node.h"
#include "linuxboard/shim/board_kernel.h"
#include "linuxboard/shim/process.h"
#include "linuxboard/shim/spec.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::linuxboard {

inline constexpr cosim::PortIndex kUartPort = 0;
inline constexpr cosim::PortIndex kI2cPort = 1;

class LinuxNode : public cosim::Node {
  public:
    /// Checks the program and starts it; it runs only from the first advance on. Throws InputError.
    explicit LinuxNode(LinuxSpec spec);

    std::string_view name() const override { return spec_.name; }
    std::span<const cosim::Port> ports() const override { return ports_; }
    void advance(cosim::Time until, std::span<const cosim::Message> inbox,
                 std::vector<cosim::Message>& outbox) override;
    cosim::Time promise(cosim::PortIndex port) const override;
    cosim::Time reaction(cosim::PortIndex port) const override;
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
    /// Requests the program made so far.
    std::uint64_t requests() const { return requests_; }

  private:
    enum class State {
        Off,      ///< not started, down between a kill and a restart, or ended
        Asking,   ///< `request_` stands at its time and is not yet handled
        Waiting,  ///< all threads wait; a device, `request_.wait_until` or a signal goes on
    };

    void start_program();
    void program_ended(cosim::Time now);
    void ended_winding_up(cosim::Time now);
    void out_of_grace(cosim::Time now);
    void note_devices();
    void handle_request();
    void answer(cosim::Time now);
    void listen();
    /// Lets devices and deliveries happen up to and including `now`, in order.
    void run_devices(cosim::Time now);
    cosim::Time next_scheduled() const;
    void run_scheduled(cosim::Time now);
    cosim::Time next_device_event() const;
    cosim::Time next_action() const;
    void collect(std::vector<cosim::Message>& outbox);
    void warn(std::string line);
    void pace(cosim::Time time);
    std::string last_words() const;
    void end_run(cosim::Time now, bool success, std::string reason, std::uint32_t programs);

    LinuxSpec spec_;
    std::vector<cosim::Port> ports_;
    std::unique_ptr<Process> process_;
    BoardKernel kernel_;
    State state_ = State::Off;
    wire::Request request_;
    std::string request_data_;
    cosim::Time until_ = 0;
    cosim::Time start_at_ = cosim::kNever;
    std::size_t next_restart_ = 0;
    std::size_t next_signal_ = 0;
    std::size_t next_hangup_ = 0;
    std::uint64_t pending_signals_ = 0;  ///< bit n: signal n
    int end_signal_ = 0;                 ///< the run ends: this one was or will be sent
    cosim::Time end_signal_at_ = cosim::kNever;
    cosim::Time kill_at_ = cosim::kNever;
    cosim::Time wound_up_ = 0;
    bool never_opened_ = false;
    std::vector<cosim::Message> inbox_;
    std::size_t inbox_next_ = 0;
    std::vector<cosim::Message>* outbox_ = nullptr;
    std::optional<cosim::Stop> stop_;
    std::vector<std::string> warnings_;
    std::uint64_t requests_ = 0;
    std::uint64_t starts_ = 0;
    std::uint64_t messages_in_ = 0;
    std::string end_;
    bool announced_exit_ = false;
    cosim::Time exit_time_ = 0;
};

}  // namespace puckloop::linuxboard
